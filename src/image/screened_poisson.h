#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "castray/large_allocator.h"

namespace castray {

/// A value of every pixel, with a border of zeros one pixel wide. Rows begin at cache lines.
struct PixelPlane {
  static constexpr int line = 16;  ///< values of a cache line

  int stride = 0;
  LargeVector<float> values;

  PixelPlane() = default;
  PixelPlane(int width, int height) : stride(stride_of(width)), values(size_of(width, height)) {}
  static std::uint64_t bytes_of(int width, int height) {
    return bytes_in_large_pages(sizeof(float) * size_of(width, height));
  }
  /// Row -1 <= y <= height, so that columns -1 <= x <= width can be read.
  float* row(int y) {
    return &values[line + static_cast<std::size_t>(y + 1) * static_cast<std::size_t>(stride)];
  }
  const float* row(int y) const { return const_cast<PixelPlane*>(this)->row(y); }

 private:
  /// The zeros after a row are those before the next.
  static int stride_of(int width) { return (width + line) / line * line; }
  static std::size_t size_of(int width, int height) {
    return line + static_cast<std::size_t>(stride_of(width)) * static_cast<std::size_t>(height + 2);
  }
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

/// Of what is solved for: the energy's weights, and b of three channels.
struct PixelEquations {
  PixelCouplings a;
  PixelPlanes b;

  PixelEquations() = default;
  PixelEquations(int width, int height);
};

/// Solves for the x at which the energy, minus 2 sum b_p x_p, is least, for three channels b. Approximately,
/// by a fixed number of multigrid cycles from zero, so that x is a linear function of b and the same for any
/// number of threads.
class ScreenedPoisson {
 public:
  ScreenedPoisson(int width, int height, int threads);
  ~ScreenedPoisson();
  ScreenedPoisson(const ScreenedPoisson&) = delete;
  ScreenedPoisson& operator=(const ScreenedPoisson&) = delete;

  /// Uses the equations up.
  PixelPlanes solve(PixelEquations equations);

 private:
  class Multigrid;
  std::unique_ptr<Multigrid> multigrid_;
};

/// The memory that this takes, with one of the equations.
std::uint64_t bytes_to_solve(int width, int height, int threads);

}  // namespace castray
