#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "castray/vec.h"

namespace castray {

/// Adds light along the unit vector w to the bins around it, of a row of guide_bins.
void spread(const Vec3d& w, double weight, double* row);

/// Of rows of weights of guide_bins: for each row guide_bins + 1 numbers, from 0 to 1.
std::vector<float> cumulative_of(const std::vector<double>& weights);

/// Two places of a grid, with their weights.
struct GridShare {
  std::size_t at;
  double weight;
};
using GridShares = std::array<GridShare, 2>;

/// The two places of a grid of `count` whose centres are around x, with linear weights; the last or first one
/// twice beyond.
GridShares around(double x, std::size_t count);

}  // namespace castray
