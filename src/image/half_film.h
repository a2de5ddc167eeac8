#pragma once

#include "castray/film.h"
#include "image/screened_poisson.h"

namespace castray {

/// What one half of a film's samples says of its pixels. Radiance is that of reflected light. Noise is the
/// estimated variance of one sample, from a pixel and its eight neighbours, or from the pixel alone if that
/// is greater; infinite where there are too few samples to tell.
struct HalfFilm {
  PixelPlane count;   ///< samples
  PixelPlanes mean;   ///< radiance
  PixelPlanes guide;  ///< the mean over 3x3 pixels, never 0
  PixelPlane noise;   ///< of a pixel p, over p^2

  /// Of a pixel p and its neighbour q to the right, or below; at p.
  struct Pairs {
    PixelPlane count;         ///< samples in which both are in one tile
    PixelPlanes here, there;  ///< mean radiance of p, and of q, over these, less that over all samples
    PixelPlane noise;         ///< of q - c p, over q^2; c = q / p
  } right, below;

  HalfFilm(const Film& film, int half, int threads);
};

}  // namespace castray
