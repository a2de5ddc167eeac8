#pragma once

#include <cstdint>
#include <memory>

#include "image/pixel_plane.h"

namespace castray {

/// The weights of an energy over the pixels' values x, a sum of screen_p x_p^2 over the pixels p, of
/// right_p (x_q - x_p)^2 over p and its neighbour q to the right, and of below_p (x_q - x_p)^2.
struct PixelCouplings {
  int width = 0, height = 0;
  CouplingPlane screen, right, below;

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
