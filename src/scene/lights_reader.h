#pragma once

#include <string_view>
#include <vector>

#include "castray/scene.h"
#include "scene/json_reader.h"

namespace castray {

/// Reads a member of "lights" of a scene file, in the file's own coordinates. Throws InputError.
DeltaLight read_delta_light(const JsonNode& node);

/// The keys that it may have.
inline const std::vector<std::string_view> light_keys = {
    "type", "position", "direction", "look_at", "intensity", "irradiance", "inner_angle", "outer_angle"};

}  // namespace castray
