#pragma once

#include <array>

#include "castray/differences.h"
#include "image/screened_poisson.h"

namespace castray {

/// How much of the corrections of both halves makes the image best, in [0,1]: the coefficient of a control
/// variate (Rousselle, Jarosz, Novak 2016), by regression over all pixels.
///
/// A correction has the expectation 0 given the other half, whose means therefore stand for the truth in
/// what covariance the errors of means have with corrections. Where these errors are each pixel's own, as
/// those of rare bright samples, it is small: such noise is not spread.
double share_of_corrections(const DifferenceSums& sums, const std::array<PixelPlanes, 2>& corrections,
                            int threads);

}  // namespace castray
