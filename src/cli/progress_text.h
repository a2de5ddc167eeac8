#pragma once

#include <optional>
#include <string>

namespace castray::cli {

/// How far a render is.
struct ProgressState {
  double fraction = 0;         ///< in [0,1]
  double elapsed = 0;          ///< seconds
  std::optional<double> left;  ///< seconds, where that can be told
  double samples_per_second = 0;
};

/// 75 s as "1:15".
std::string clock_time(double seconds);

/// For a log.
std::string line_text(const ProgressState& state);
/// For a terminal: shorter than `columns` where that can be, so that the line does not wrap.
std::string bar_text(const ProgressState& state, int columns);
/// For programs: one JSON object in one line.
std::string json_text(const ProgressState& state);
std::string json_text(const std::string& phase, double elapsed);

/// `text`, cut to be shorter than `columns`.
std::string shortened(const std::string& text, int columns);

/// Of the terminal that stderr is; of any other, COLUMNS or 80.
int terminal_columns();

}  // namespace castray::cli
