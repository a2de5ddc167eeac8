#pragma once

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "castray/scene.h"

namespace castray {

/// The member of a scene file's "materials" that is read as `material`; `path_of` gives the path of each of
/// the scene's textures.
nlohmann::ordered_json material_json(const Material& material, const Scene& scene,
                                     const std::function<std::string(int texture)>& path_of);

}  // namespace castray
