#pragma once

#include <string_view>
#include <vector>

#include "castray/camera.h"
#include "scene/json_reader.h"

namespace castray {

/// Reads "camera" of a scene file, in the file's own coordinates. Throws InputError.
Camera read_camera(const JsonNode& node);

// The keys that it may have.
inline const std::vector<std::string_view> camera_keys = {"type", "position", "look_at", "up",
                                                          "fov",  "height",   "shift",   "lens"};
inline const std::vector<std::string_view> lens_keys = {
    "radius", "f_number", "sensor_height", "focus_distance", "focus_on", "blades", "rotation"};

}  // namespace castray
