#pragma once

#include <array>

#include "castray/film.h"
#include "image/screened_poisson.h"

namespace castray {

/// Of which half of the samples weights are. Weights of its own would make an image darker.
enum class WeightsOf { other_half, same_half };

/// Whether no pixel has more samples of the second half than are needed before weights that the halves give
/// each other are better than the same ones everywhere, and differences of both halves in one system.
bool has_few_samples(const DifferenceSums& sums);

/// What to add to the means of all samples, over the film's scale, with weights from their numbers alone.
PixelPlanes correction_of_few(const DifferenceSums& sums, int threads);

/// What to add to the means of both halves of the samples, over the film's scale, each from its own
/// differences.
///
/// Gradient-domain path reusing (Bauszat, Petitjean, Eisemann 2017), a control variate in image space
/// (Rousselle, Jarosz, Novak 2016). docs/transport.md has the formula.
std::array<PixelPlanes, 2> corrections(const DifferenceSums& sums, int threads,
                                       WeightsOf weights = WeightsOf::other_half);

}  // namespace castray
