#pragma once

#include <limits>
#include <string>

namespace castray {

/// Bounds of a number; those named `above` and `below` are themselves outside.
struct Range {
  double least = -std::numeric_limits<double>::max();
  double greatest = std::numeric_limits<double>::max();
  bool above_least = false, below_greatest = false;

  bool contains(double value) const;
  std::string text() const;
};

inline constexpr Range unit_range{.least = 0, .greatest = 1};
inline constexpr Range not_negative{.least = 0};
inline constexpr Range positive{.least = 0, .above_least = true};

}  // namespace castray
