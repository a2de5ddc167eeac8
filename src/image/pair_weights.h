#pragma once

#include "castray/differences.h"
#include "image/screened_poisson.h"

namespace castray {

/// How far one half of a film's samples would trust its own means and differences: one over their estimated
/// variances, in luminance. 0 where the half has none.
///
/// Estimates come from how smooth the image is. A mean and a difference say the same of two pixels, but for
/// the samples in which these were in different tiles; so what they contradict each other tells the variance
/// of the means. That of differences is at most how much they vary among neighbours.
///
/// `luminances`: memory, whose border is zero and stays so.
void find_weights(const DifferenceSums& sums, int half, int threads, PixelPlanes& luminances,
                  PixelCouplings& weights);

}  // namespace castray
