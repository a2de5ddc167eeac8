#pragma once

#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "temporary_folder.h"

/// What a run of the program left behind.
struct RunResult {
  int exit_code = -1;  ///< 128 + signal where one ended it
  std::string out, err;
  long peak_kilobytes = 0;

  std::size_t error_lines() const {
    return static_cast<std::size_t>(std::count(err.begin(), err.end(), '\n'));
  }
};

/// How to run the program besides its arguments.
struct RunSettings {
  std::filesystem::path folder{};                                ///< to run in
  std::vector<std::pair<std::string, std::string>> variables{};  ///< environment
  std::string input_file = "/dev/null";
  std::string output_file{};            ///< in place of RunResult::out
  unsigned seconds = 120;               ///< ends it with SIGALRM
  int signal = 0;                       ///< sent once it has written to stderr
  rlim_t largest_file = RLIM_INFINITY;  ///< in bytes
};

inline std::string file_content(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Runs the built program and waits for its end.
inline RunResult run_castray(const std::vector<std::string>& arguments, const RunSettings& settings = {}) {
  const TemporaryFolder capture;
  const std::string out = settings.output_file.empty() ? std::string(capture / "out") : settings.output_file;
  const std::string err = capture / "err";
  std::vector<char*> argv{const_cast<char*>(CASTRAY_PROGRAM)};
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);

  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("cannot fork");
  if (child == 0) {
    const auto redirect = [](int descriptor, const std::string& file, int flags) {
      const int opened = open(file.c_str(), flags, 0666);
      if (opened < 0 || dup2(opened, descriptor) < 0) _exit(126);
      close(opened);
    };
    redirect(0, settings.input_file, O_RDONLY);
    redirect(1, out, O_WRONLY | O_CREAT | O_TRUNC);
    redirect(2, err, O_WRONLY | O_CREAT | O_TRUNC);
    if (!settings.folder.empty() && chdir(settings.folder.c_str()) != 0) _exit(126);
    for (const auto& [name, value] : settings.variables) setenv(name.c_str(), value.c_str(), 1);
    const rlimit largest_file{settings.largest_file, settings.largest_file};
    if (setrlimit(RLIMIT_FSIZE, &largest_file) != 0) _exit(126);
    alarm(settings.seconds);
    execv(argv[0], argv.data());
    _exit(127);
  }
  if (settings.signal != 0) {
    while (file_content(err).empty() && waitpid(child, nullptr, WNOHANG) == 0) usleep(10000);
    kill(child, settings.signal);
  }
  int status = 0;
  rusage usage{};
  wait4(child, &status, 0, &usage);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status),
          settings.output_file.empty() ? file_content(out) : "", file_content(err), usage.ru_maxrss};
}

/// The same, in `folder`.
inline RunResult run_castray(const std::vector<std::string>& arguments, const std::filesystem::path& folder) {
  return run_castray(arguments, RunSettings{.folder = folder});
}
