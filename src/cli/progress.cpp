#include "cli/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <string>

namespace castray::cli {

namespace {

constexpr double seconds_between_bars = 0.1, seconds_between_lines = 3;

/// 75 s as "1:15".
std::string clock_time(double seconds) {
  const auto s = static_cast<long long>(std::llround(seconds));
  return s < 3600 ? fmt::format("{}:{:02}", s / 60, s % 60)
                  : fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60);
}

}  // namespace

ProgressDisplay::ProgressDisplay(ProgressMode mode) : mode_(mode) {
  if (mode_ == ProgressMode::automatic)
    mode_ = isatty(STDERR_FILENO) ? ProgressMode::bar : ProgressMode::lines;
  if (mode_ == ProgressMode::lines) next_ = 1;
}

void ProgressDisplay::update(const Progress& progress) {
  if (mode_ == ProgressMode::off) return;
  const double elapsed = std::chrono::duration<double>(Clock::now() - begin_).count();
  if (first_fraction_ < 0) first_fraction_ = progress.fraction;  // a resumed render does not start at 0
  if (elapsed < next_) return;
  const bool bar = mode_ == ProgressMode::bar;
  next_ = elapsed + (bar ? seconds_between_bars : seconds_between_lines);

  const double done_here = progress.fraction - first_fraction_;
  const std::string left =
      done_here > 0 ? clock_time(elapsed * (1 - progress.fraction) / done_here) + " left" : "? left";
  const std::string numbers = fmt::format(
      "{:5.1f} %  {} elapsed  {}  {:.2f} Msamples/s", 100 * progress.fraction, clock_time(elapsed), left,
      elapsed > 0 ? static_cast<double>(progress.paths) / elapsed * 1e-6 : 0);
  if (bar) {
    constexpr int width = 24;
    const int full = static_cast<int>(progress.fraction * width);
    const std::string cells = std::string(static_cast<std::size_t>(full), '#') +
                              std::string(static_cast<std::size_t>(width - full), '.');
    fmt::print(stderr, "\r[{}] {}\x1b[K", cells, numbers);
    std::fflush(stderr);
    line_open_ = true;
  } else {
    fmt::print(stderr, "castray: {}\n", numbers);
  }
}

void ProgressDisplay::tell(const std::string& message) {
  fmt::print(stderr, "{}castray: {}\n", line_open_ ? "\r\x1b[K" : "", message);
  line_open_ = false;
}

void ProgressDisplay::finish() {
  if (line_open_) fmt::print(stderr, "\n");
  line_open_ = false;
}

}  // namespace castray::cli
