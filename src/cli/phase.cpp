#include "cli/phase.h"

#include <fmt/format.h>

#include <utility>

#include "cli/progress.h"

namespace castray::cli {

Phase::Phase(ProgressMode mode, std::string what) : mode_(chosen_mode(mode)), what_(std::move(what)) {
  if (mode_ == ProgressMode::json) fmt::print(stderr, "{}\n", json_text(what_, 0));
  if (mode_ != ProgressMode::off) thread_ = std::jthread([this](const std::stop_token& stop) { tell(stop); });
}

Phase::~Phase() = default;  // the thread is told to stop, and waited for

void Phase::tell(const std::stop_token& stop) {
  const auto begin = std::chrono::steady_clock::now();
  bool line_open = false;
  std::unique_lock lock(mutex_);
  for (std::chrono::duration<double> pause{1};;) {
    ended_.wait_for(lock, stop, pause, [] { return false; });
    if (stop.stop_requested()) break;
    const double elapsed = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    const std::string text = fmt::format("castray: {}  {}", what_, clock_time(elapsed));
    if (mode_ == ProgressMode::bar) {
      fmt::print(stderr, "\r{}\x1b[K", shortened(text, terminal_columns()));
      std::fflush(stderr);
      line_open = true;
      continue;
    }
    fmt::print(stderr, "{}\n", mode_ == ProgressMode::json ? json_text(what_, elapsed) : text);
    pause *= 2;
  }
  if (line_open) fmt::print(stderr, "\r\x1b[K");
}

}  // namespace castray::cli
