#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "scene/json_document.h"
#include "scene/transform.h"

namespace castray {

inline const std::vector<std::string_view> transform_step_keys{"scale", "rotate", "translate", "matrix"};

/// The steps of a "transform", one after the other. Throws InputError where one flattens space.
Transform read_transform(const JsonNode& node);

/// Where the copies of an object are: the "transforms" of an instance, an array of arrays of 12 numbers, or
/// the name of a file next to `scene_file` with 12 numbers a line; the rows of a matrix of three rows and
/// four columns, the last of them the translation. Throws InputError where one flattens space.
std::vector<Transform> read_transforms(const JsonNode& node, const std::filesystem::path& scene_file);

}  // namespace castray
