#pragma once

#include <string>

#include "castray/scene.h"

namespace castray::cli {

inline constexpr const char* dark_scene = "nothing in the scene emits light: the image will be black";

/// Whether the scene has neither lights nor an environment that shines.
bool is_dark(const Scene& scene);

/// A point in the world, with as many digits as the scene's floats tell apart, and no more.
std::string world_point(const Scene& scene, const Vec3d& in_scene_space, const char* separator = ",");

/// From a camera in scene space to what it looks at: as far away as the scene's middle, or nearly.
double view_distance(const Camera& camera);

/// A view of the scene as flags, and as "camera" of a scene file.
std::string view_flags(const Scene& scene, const Camera& camera);
std::string view_json(const Scene& scene, const Camera& camera);

}  // namespace castray::cli
