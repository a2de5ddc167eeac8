#pragma once

#include <vector>

#include "castray/image.h"

namespace castray {

/// Pixels that count (true) in row order; empty: all of them.
using PixelMask = std::vector<bool>;

/// Two independent renders of the same image, both unbiased.
struct ReferencePair {
  Image a, b;

  /// (a + b) / 2, the best single reference.
  Image mean() const;
};

struct NoiseFreeErrors {
  double mse = 0, relmse = 0;
};

/// Mean over counted pixels and channels of (x - a)(x - b) and of (x - a)(x - b) / (r^2 + 0.01), r = (a +
/// b)/2: as a and b are independent of each other and of x, their noise has mean 0 in the product and the
/// expectation is x's own squared error. So close to 0 an estimate may be negative. All images have one size.
NoiseFreeErrors noise_free_errors(const Image& x, const ReferencePair& reference, const PixelMask& mask = {});

/// The relMSE of the reference's mean, from what a and b differ by.
double reference_noise(const ReferencePair& reference, const PixelMask& mask = {});

/// Which pixels see no emitter, nor have a neighbour (of 8) that does. `emission`: the image with a path
/// length of one edge, so that only directly seen emitters are not black. Pixels on an emitter's edge have by
/// far the highest variance of all, which box-filtered sampling of the camera alone decides; so renderers are
/// compared without them.
PixelMask away_from_emitters(const Image& emission);

}  // namespace castray
