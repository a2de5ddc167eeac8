#pragma once

#include <limits>
#include <string>

namespace castray {

/// Bounds of a number; those named `above` and `below` are themselves outside.
struct Range {
  double least = -std::numeric_limits<double>::max();
  double greatest = std::numeric_limits<double>::max();
  bool above_least = false, below_greatest = false;
  double least_but_zero = 0;  ///< greater than 0: numbers are 0, or at least this

  bool contains(double value) const;  ///< false for nan
  std::string text() const;
};

inline constexpr Range unit_range{.least = 0, .greatest = 1};
inline constexpr Range not_negative{.least = 0};

// What kernels compute in floats, from 1e-38 to 3e38, has room on both sides of these.
inline constexpr Range radiance_range{.least = 0, .greatest = 1e30, .least_but_zero = 1e-30};
/// Of indices of refraction: beyond, Fresnel's equations lose all digits.
inline constexpr Range index_range{.least = 0, .greatest = 1e4, .above_least = true};
inline constexpr Range float_range{.least = -1e30, .greatest = 1e30};

/// Of a camera, in degrees. Floats do not tell the rays of a narrower one apart.
inline constexpr Range fov_range{.least = 1e-5, .greatest = 180, .below_greatest = true};

/// Of the world. Products of three of these are finite doubles.
inline constexpr double farthest_coordinate = 1e100;
inline constexpr Range coordinate_range{.least = -farthest_coordinate, .greatest = farthest_coordinate};
inline constexpr Range length_range{.least = 1 / farthest_coordinate, .greatest = farthest_coordinate};

}  // namespace castray
