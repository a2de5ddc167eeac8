#include "cli/progress_text.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>

namespace castray::cli {

namespace {

double rounded(double value, double unit) { return std::round(value / unit) * unit; }

std::string cells_text(double fraction, int width) {
  const int full = static_cast<int>(fraction * width);
  return fmt::format("[{:#<{}}{:.<{}}] ", "", full, "", width - full);
}

std::string time_left(const ProgressState& s) { return (s.left ? clock_time(*s.left) : "?") + " left"; }

}  // namespace

std::string clock_time(double seconds) {
  const auto s = static_cast<long long>(std::llround(seconds));
  return s < 3600 ? fmt::format("{}:{:02}", s / 60, s % 60)
                  : fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60);
}

std::string line_text(const ProgressState& s) {
  return fmt::format("{:5.1f} %  {} elapsed  {}  {:.2f} Msamples/s", 100 * s.fraction, clock_time(s.elapsed),
                     time_left(s), s.samples_per_second * 1e-6);
}

std::string bar_text(const ProgressState& s, int columns) {
  const std::string percent = fmt::format("{:5.1f} %", 100 * s.fraction);
  const std::string candidates[] = {
      cells_text(s.fraction, 24) + line_text(s),
      cells_text(s.fraction, 12) +
          fmt::format("{}  {} elapsed  {}", percent, clock_time(s.elapsed), time_left(s)),
      cells_text(s.fraction, 8) + percent + "  " + time_left(s),
      percent + "  " + time_left(s),
  };
  for (const std::string& text : candidates)
    if (static_cast<int>(text.size()) < columns) return text;
  return shortened(percent, columns);
}

std::string json_text(const ProgressState& s) {
  nlohmann::ordered_json object = {{"phase", "rendering"},
                                   {"fraction", rounded(s.fraction, 1e-4)},
                                   {"elapsed_seconds", rounded(s.elapsed, 1e-3)},
                                   {"samples_per_second", std::round(s.samples_per_second)}};
  if (s.left) object["seconds_left"] = rounded(*s.left, 0.1);
  return object.dump();
}

std::string json_text(const std::string& phase, double elapsed) {
  return nlohmann::ordered_json{{"phase", phase}, {"elapsed_seconds", rounded(elapsed, 1e-3)}}.dump(
      -1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

std::string shortened(const std::string& text, int columns) {
  return text.substr(0, static_cast<std::size_t>(std::max(columns - 1, 0)));
}

int terminal_columns() {
  winsize size{};
  if (ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0) return size.ws_col;
  const char* columns = std::getenv("COLUMNS");
  const int given = columns ? std::atoi(columns) : 0;
  return given > 0 ? given : 80;
}

}  // namespace castray::cli
