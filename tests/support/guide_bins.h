#pragma once

#include <catch2/catch.hpp>

#include <vector>

#include "lights/light_records.h"

namespace castray::test {

/// The probability of each bin of directions, of a row of cumulative ones.
inline std::vector<double> probabilities_of(const float* row) {
  CHECK(row[0] == 0);
  CHECK(row[guide_bins] == 1);
  std::vector<double> bins;
  for (std::size_t i = 0; i < guide_bins; ++i) {
    CHECK(row[i + 1] >= row[i]);
    bins.push_back(double{row[i + 1]} - double{row[i]});
  }
  return bins;
}

/// The bin of square (a,b) of a face of the cube of directions.
inline std::size_t guide_bin(std::size_t face, std::size_t a, std::size_t b) {
  return (face * guide_steps + a) * guide_steps + b;
}

/// The coordinate of the middle of a square, from -1 to 1.
inline float middle_of_step(std::size_t step) {
  return (static_cast<float>(step) + 0.5f) * 2 / guide_steps - 1;
}

}  // namespace castray::test
