#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "scene/json_reader.h"
#include "scene/scene_builder.h"

namespace castray {

/// The type of a material that is another one on each side, which scene/named_materials.h reads.
inline constexpr std::string_view pair_type = "two_sided";

/// Reads one member of a scene file's "materials", no pair: a constant or an image for each key that the
/// descriptor of its type has. Textures go to the builder; their paths are relative to `file`. Throws
/// InputError.
Material read_material(const JsonNode& node, const std::filesystem::path& file, SceneBuilder& builder);

/// The keys of an image that gives a parameter its value.
const std::vector<std::string_view>& map_keys();

/// The keys of what a dielectric absorbs, in place of its coefficients.
const std::vector<std::string_view>& absorption_keys();

/// The keys of a metal's complex index of refraction, in place of a reflectance.
const std::vector<std::string_view>& index_keys();

/// The index of `name` among `names`, or an error that suggests the nearest.
std::size_t choose(const JsonNode& node, std::string_view name, const std::vector<std::string_view>& names);

}  // namespace castray
