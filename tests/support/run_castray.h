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
#include <sstream>
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

  /// `err` without the lines that tell of reading, which are there if it takes more than a second.
  std::string but_for_reading() const {
    std::istringstream lines(err);
    std::string rest;
    for (std::string line; std::getline(lines, line);)
      if (!line.starts_with("castray: reading ")) rest += line + '\n';
    return rest;
  }

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
  std::string error_file{};             ///< in place of RunResult::err
  unsigned seconds = 120;               ///< ends it with SIGALRM
  int signal = 0;                       ///< sent once it has written to stderr
  rlim_t largest_file = RLIM_INFINITY;  ///< in bytes
  bool own_session = false;             ///< the first terminal that it opens controls it
};

inline std::string file_content(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// The built program, running.
class CastrayProcess {
 public:
  CastrayProcess(const std::vector<std::string>& arguments, const RunSettings& settings)
      : settings_(settings) {
    std::vector<char*> argv{const_cast<char*>(CASTRAY_PROGRAM)};
    for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
    argv.push_back(nullptr);
    child_ = fork();
    if (child_ < 0) throw std::runtime_error("cannot fork");
    if (child_ == 0) become(argv);
  }
  ~CastrayProcess() {
    if (!ended()) {
      kill(child_, SIGKILL);
      wait();
    }
  }
  CastrayProcess(const CastrayProcess&) = delete;
  CastrayProcess& operator=(const CastrayProcess&) = delete;

  std::string err() const { return file_content(err_); }
  void send(int signal) const { kill(child_, signal); }
  bool ended() {
    if (!ended_) ended_ = wait4(child_, &status_, WNOHANG, &usage_) != 0;
    return ended_;
  }
  /// Waits until `condition` holds or the program has ended; returns which.
  template <class Condition>
  bool wait_until(Condition condition) {
    while (!condition()) {
      if (ended()) return condition();
      usleep(10000);
    }
    return true;
  }
  RunResult wait() {
    if (!ended_) wait4(child_, &status_, 0, &usage_);
    ended_ = true;
    return {WIFEXITED(status_) ? WEXITSTATUS(status_) : 128 + WTERMSIG(status_),
            settings_.output_file.empty() ? file_content(out_) : "", err(), usage_.ru_maxrss};
  }

 private:
  [[noreturn]] void become(const std::vector<char*>& argv) const {
    if (settings_.own_session && setsid() < 0) _exit(126);
    const auto redirect = [](int descriptor, const std::string& file, int flags) {
      const int opened = open(file.c_str(), flags, 0666);
      if (opened < 0 || dup2(opened, descriptor) < 0) _exit(126);
      close(opened);
    };
    redirect(0, settings_.input_file, O_RDONLY);
    redirect(1, settings_.output_file.empty() ? out_ : settings_.output_file, O_WRONLY | O_CREAT | O_TRUNC);
    redirect(2, settings_.error_file.empty() ? err_ : settings_.error_file, O_WRONLY | O_CREAT | O_TRUNC);
    if (!settings_.folder.empty() && chdir(settings_.folder.c_str()) != 0) _exit(126);
    for (const auto& [name, value] : settings_.variables) setenv(name.c_str(), value.c_str(), 1);
    const rlimit largest_file{settings_.largest_file, settings_.largest_file};
    if (setrlimit(RLIMIT_FSIZE, &largest_file) != 0) _exit(126);
    alarm(settings_.seconds);
    execv(argv[0], argv.data());
    _exit(127);
  }

  RunSettings settings_;
  TemporaryFolder capture_;
  std::string out_ = capture_ / "out", err_ = capture_ / "err";
  pid_t child_ = -1;
  int status_ = 0;
  rusage usage_{};
  bool ended_ = false;
};

/// Runs the built program and waits for its end.
inline RunResult run_castray(const std::vector<std::string>& arguments, const RunSettings& settings = {}) {
  CastrayProcess process(arguments, settings);
  if (settings.signal != 0) {
    process.wait_until([&] { return !process.err().empty(); });
    if (!process.ended()) process.send(settings.signal);
  }
  return process.wait();
}

/// The same, in `folder`.
inline RunResult run_castray(const std::vector<std::string>& arguments, const std::filesystem::path& folder) {
  return run_castray(arguments, RunSettings{.folder = folder});
}
