#pragma once

#include <vector>

#include "castray/scene.h"

namespace castray {

/// What part of the sphere a row of an image in latitude and longitude covers.
double share_of_row(int row, int height);

/// The radiance of each texel of the scene's environment image, the top row first.
std::vector<Vec3f> environment_radiance(const Scene& scene);

/// Its mean over all directions.
Vec3d mean_environment(const Scene& scene);

}  // namespace castray
