#include "cli/process.h"

#include <sys/wait.h>

#include <chrono>
#include <cstdio>
#include <sstream>

#include "castray/error.h"
#include "cli/shell_word.h"
#include "cli/temporary_folder.h"
#include "core/files.h"

namespace castray::cli {

namespace {

std::string last_line(const std::string& text) {
  std::istringstream lines(text);
  std::string line, last;
  while (std::getline(lines, line))
    if (line.find_first_not_of(" \t\r") != std::string::npos) last = line;
  return last;
}

}  // namespace

int exit_code_of(int status) { return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status); }

ProcessResult run_command(const std::string& command) {
  const TemporaryFolder folder;
  const std::string errors = (folder.path() / "stderr").string();
  ProcessResult result;
  const auto start = std::chrono::steady_clock::now();
  FILE* pipe = popen(("{ " + command + "\n} 2>" + shell_word(errors)).c_str(), "r");
  if (!pipe) throw InputError("cannot start a shell for: " + command);
  char buffer[4096];
  while (const std::size_t count = std::fread(buffer, 1, sizeof buffer, pipe))
    result.output.append(buffer, count);
  result.exit_code = exit_code_of(pclose(pipe));
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  result.last_error = last_line(read_file(errors));
  return result;
}

}  // namespace castray::cli
