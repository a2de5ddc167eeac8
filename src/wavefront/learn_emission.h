#pragma once

#include <cstddef>
#include <vector>

#include "lights/emission_guide.h"
#include "wavefront/pilot.h"

namespace castray {

/// What light paths tell of caustics.
struct FocusedLight {
  std::vector<UsefulEmission> emission;  ///< what lights emit that mirrors and glass are the first to scatter
  std::vector<UsefulEmission> arrivals;  ///< where other surfaces get it, and from which directions
};

/// Of one light path for each pixel, within bounds; arrivals if they are wanted. A function of the scene, the
/// image's full size and the options but their seed, as a pilot is.
FocusedLight focused_light(const Pilot& pilot, KernelOptions options, bool arrivals,
                           const LightPathsJob& light_paths_job);

/// How many light paths a pixel needs for as many to be useful as of one without a guide; 1 if a guide is not
/// worth it. `unguided`, `guided`: how many of a number of light paths are useful.
double light_paths_enough(std::size_t unguided, std::size_t guided);

}  // namespace castray
