#pragma once

#include <string>

#include "castray/scene.h"

namespace castray::cli {

inline constexpr const char* dark_scene = "nothing in the scene emits light: the image will be black";

/// Whether the scene has neither lights nor an environment that shines.
bool is_dark(const Scene& scene);

/// A point in the world, with as many digits as the scene's floats tell apart, and no more.
std::string world_point(const Scene& scene, const Vec3d& in_scene_space, const char* separator = ",");

/// The scene's view as flags, and as "camera" of a scene file.
std::string view_flags(const Scene& scene);
std::string view_json(const Scene& scene);

}  // namespace castray::cli
