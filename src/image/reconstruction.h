#pragma once

#include <array>

#include "castray/film.h"
#include "image/screened_poisson.h"

namespace castray {

/// Of which half of the samples weights are. Weights of its own would make an image darker.
enum class WeightsOf { other_half, same_half };

/// What to add to the means of both halves of the samples, over the film's scale, each from its own
/// differences.
///
/// Gradient-domain path reusing (Bauszat, Petitjean, Eisemann 2017), a control variate in image space
/// (Rousselle, Jarosz, Novak 2016). docs/transport.md has the formula.
std::array<PixelPlanes, 2> corrections(const DifferenceSums& sums, int threads,
                                       WeightsOf weights = WeightsOf::other_half);

}  // namespace castray
