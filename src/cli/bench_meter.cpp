#include "cli/bench_meter.h"

#include <fmt/core.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>

namespace castray::cli {

namespace {

constexpr auto terminal_interval = std::chrono::milliseconds(200);
constexpr auto log_interval = std::chrono::seconds(5);

std::string time_text(double seconds) {
  const auto whole = static_cast<long>(std::ceil(seconds));
  return whole < 60 ? fmt::format("{} s", whole) : fmt::format("{} min {:02} s", whole / 60, whole % 60);
}

}  // namespace

BenchMeter::BenchMeter(bool quiet) : quiet_(quiet), terminal_(isatty(STDERR_FILENO) != 0) {}

void BenchMeter::tell(const BenchProgress& progress) {
  const auto now = Clock::now();
  if (quiet_ || now - last_ < (terminal_ ? std::chrono::nanoseconds(terminal_interval) : log_interval))
    return;
  last_ = now;
  fmt::print(stderr, "{}bench: {:3.0f} %, {} left: {}{}", terminal_ ? "\r\033[K" : "",
             100 * progress.fraction, time_text(progress.seconds_left), progress.what, terminal_ ? "" : "\n");
  std::fflush(stderr);
}

void BenchMeter::tell_part(const std::string& what, double fraction) {
  if (part_ != what) {
    part_ = what;
    part_begin_ = Clock::now();
  }
  const double elapsed = std::chrono::duration<double>(Clock::now() - part_begin_).count();
  if (fraction > 0) tell({what, fraction, elapsed * (1 - fraction) / fraction});
}

void BenchMeter::clear() {
  if (!quiet_ && terminal_) fmt::print(stderr, "\r\033[K");
}

}  // namespace castray::cli
