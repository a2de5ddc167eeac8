#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

#include "cli/render_flags.h"

namespace castray::cli {

/// Says on stderr what the program is at, as long as this object lives: to people once that takes more than
/// a second, to programs from the beginning.
class Phase {
 public:
  Phase(ProgressMode mode, std::string what);
  ~Phase();
  Phase(const Phase&) = delete;
  Phase& operator=(const Phase&) = delete;

 private:
  void tell(const std::stop_token& stop);

  ProgressMode mode_;
  std::string what_;
  std::mutex mutex_;
  std::condition_variable_any ended_;
  std::jthread thread_;
};

}  // namespace castray::cli
