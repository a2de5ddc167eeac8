#pragma once

#include <vector>

#include "lights/light_regions.h"
#include "wavefront/kernel_api.h"
#include "wavefront/kernel_scene.h"

namespace castray {

/// Looks for lights from where light samples are taken: follows some paths from the camera, diffuse at each
/// vertex, and at each vertex casts rays to points of some of the cut's nodes. A function of the scene and
/// the image's full size, not of `threads`. `data` needs two nodes or more.
std::vector<LightTrial> try_lights(const Scene& scene, const KernelApi& kernel, const KernelSceneData& data,
                                   int width, int height, int threads);

}  // namespace castray
