#pragma once

#include <cstddef>
#include <vector>

#include "lights/emission_guide.h"
#include "wavefront/pilot.h"

namespace castray {

/// What lights emit that mirrors and glass are the first to scatter, of one light path for each pixel, within
/// bounds. A function of the scene, the image's full size and the options but their seed, as a pilot is.
std::vector<UsefulEmission> useful_emission(const Pilot& pilot, KernelOptions options,
                                            const LightPathsJob& light_paths_job);

/// How many light paths a pixel needs for as many to be useful as of one without a guide; 1 if a guide is not
/// worth it. `unguided`, `guided`: how many of a number of light paths are useful.
double light_paths_enough(std::size_t unguided, std::size_t guided);

}  // namespace castray
