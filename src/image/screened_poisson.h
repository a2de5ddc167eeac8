#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "castray/large_allocator.h"

namespace castray {

/// A value of every pixel, with a border of zeros one pixel wide.
struct PixelPlane {
  int stride = 0;
  LargeVector<float> values;

  PixelPlane() = default;
  PixelPlane(int width, int height)
      : stride(width + 2),
        values(static_cast<std::size_t>(width + 2) * static_cast<std::size_t>(height + 2)) {}
  static std::uint64_t bytes_of(int width, int height) {
    return bytes_in_large_pages(sizeof(float) * static_cast<std::uint64_t>(width + 2) *
                                static_cast<std::uint64_t>(height + 2));
  }
  /// Row -1 <= y <= height, so that columns -1 <= x <= width can be read.
  float* row(int y) {
    return &values[static_cast<std::size_t>(y + 1) * static_cast<std::size_t>(stride) + 1];
  }
  const float* row(int y) const { return const_cast<PixelPlane*>(this)->row(y); }
};
using PixelPlanes = std::array<PixelPlane, 3>;

/// The weights of an energy over the pixels' values x, a sum of screen_p x_p^2 over the pixels p, of
/// right_p (x_q - x_p)^2 over p and its neighbour q to the right, and of below_p (x_q - x_p)^2.
struct PixelCouplings {
  int width = 0, height = 0;
  PixelPlane screen, right, below;

  PixelCouplings() = default;
  PixelCouplings(int width, int height);
};

/// Approximates the x at which the energy, minus 2 sum b_p x_p, is least, for three channels b. A fixed
/// number of multigrid cycles from zero, so that x is a linear function of b and the same for any number of
/// threads.
PixelPlanes solve_screened_poisson(PixelCouplings couplings, PixelPlanes b, int threads);

/// The memory that this takes, its arguments included.
std::uint64_t bytes_to_solve(int width, int height, int threads);

}  // namespace castray
