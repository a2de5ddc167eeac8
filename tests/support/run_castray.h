#pragma once

#include <sys/wait.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "temporary_folder.h"

struct RunResult {
  int exit_code = -1;  ///< 128 + signal where one ended it
  std::string out, err;
};

/// Runs the castray program with these arguments, in `folder` if given, and waits for it.
inline RunResult run_castray(const std::vector<std::string>& arguments,
                             const std::filesystem::path& folder = ".") {
  const auto quoted = [](const std::string& text) {
    std::string result = "'";
    for (const char c : text) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return result + "'";
  };
  const auto content = [](const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  const TemporaryFolder streams;
  std::string command = "cd " + quoted(folder.string()) + " && " + quoted(CASTRAY_PROGRAM);
  for (const std::string& argument : arguments) command += " " + quoted(argument);
  command += " >" + quoted(streams / "out") + " 2>" + quoted(streams / "err") + " </dev/null";
  const int status = std::system(command.c_str());
  const int exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return {exit_code, content(streams / "out"), content(streams / "err")};
}
