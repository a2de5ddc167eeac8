#pragma once

#include "castray/film.h"
#include "image/screened_poisson.h"

namespace castray {

/// What to add to the means of one half of the samples, over the film's scale, from its own differences and
/// with weights of the other half. Weights of its own would make the image darker.
///
/// Gradient-domain path reusing (Bauszat, Petitjean, Eisemann 2017), a control variate in image space
/// (Rousselle, Jarosz, Novak 2016). docs/transport.md has the formula.
PixelPlanes corrections(const DifferenceSums& sums, int half, int half_of_weights, int threads,
                        ScreenedPoisson& solver);

}  // namespace castray
