#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "scene/json_reader.h"
#include "scene/scene_builder.h"

namespace castray {

/// Reads "environment" of a scene file into the builder's scene; paths are relative to `file`. Throws
/// InputError.
void read_environment(const JsonNode& node, const std::filesystem::path& file, SceneBuilder& builder);

// The keys that it, its "sky" and its "gradient" may have.
inline const std::vector<std::string_view> environment_keys = {"radiance", "image", "sky",
                                                               "gradient", "scale", "rotation"};
inline const std::vector<std::string_view> sky_keys = {"turbidity", "sun_elevation", "sun_azimuth", "time",
                                                       "latitude",  "longitude",     "sun",         "ground"};
inline const std::vector<std::string_view> gradient_keys = {"zenith", "horizon", "ground"};

}  // namespace castray
