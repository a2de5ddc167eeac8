#include "cli/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>

namespace castray::cli {

namespace {

constexpr double seconds_between_bars = 0.1, seconds_between_objects = 0.5;
constexpr double first_line = 1, longest_between_lines = 600;

double time_after(ProgressMode mode, double elapsed) {
  if (mode == ProgressMode::bar) return elapsed + seconds_between_bars;
  if (mode == ProgressMode::json) return elapsed + seconds_between_objects;
  return elapsed + std::clamp(elapsed, first_line, longest_between_lines);
}

}  // namespace

ProgressMode chosen_mode(ProgressMode mode) {
  if (mode != ProgressMode::automatic) return mode;
  return isatty(STDERR_FILENO) ? ProgressMode::bar : ProgressMode::lines;
}

ProgressDisplay::ProgressDisplay(ProgressMode mode) : mode_(chosen_mode(mode)) {
  if (mode_ == ProgressMode::lines) next_ = first_line;
}

void ProgressDisplay::update(const Progress& progress) {
  if (mode_ == ProgressMode::off) return;
  if (first_fraction_ < 0) first_fraction_ = progress.fraction;  // a resumed render does not start at 0
  const double now = elapsed(), done_here = progress.fraction - first_fraction_;
  state_ = {progress.fraction, now, std::nullopt, now > 0 ? static_cast<double>(progress.paths) / now : 0};
  if (done_here > 0) state_.left = now * (1 - progress.fraction) / done_here;
  if (now < next_) return;
  next_ = time_after(mode_, now);
  show();
}

void ProgressDisplay::show() {
  shown_ = true;
  if (mode_ == ProgressMode::lines) {
    fmt::print(stderr, "castray: {}\n", line_text(state_));
  } else if (mode_ == ProgressMode::json) {
    fmt::print(stderr, "{}\n", json_text(state_));
  } else {
    fmt::print(stderr, "\r{}\x1b[K", bar_text(state_, terminal_columns()));
    std::fflush(stderr);
    line_open_ = true;
  }
}

void ProgressDisplay::tell(const std::string& message) {
  fmt::print(stderr, "{}castray: {}\n", line_open_ ? "\r\x1b[K" : "", message);
  line_open_ = false;
}

void ProgressDisplay::finish(bool complete) {
  state_.elapsed = elapsed();
  if (complete) state_.fraction = 1, state_.left = 0;
  if (shown_ || mode_ == ProgressMode::json) show();
  if (line_open_) fmt::print(stderr, "\n");
  line_open_ = false;
}

}  // namespace castray::cli
