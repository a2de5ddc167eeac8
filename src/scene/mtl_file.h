#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "scene/scene_builder.h"

namespace castray {

/// Reads the materials of an MTL file, or of the text that is its content, by the mapping that docs/scenes.md
/// describes, adds them to the builder, and returns their indices. Keys that mean nothing here go to
/// Scene::ignored_keys.
std::vector<std::uint16_t> parse_mtl(std::string_view text, const std::filesystem::path& file,
                                     SceneBuilder& builder);
std::vector<std::uint16_t> read_mtl(const std::filesystem::path& file, SceneBuilder& builder);

/// Whether there is something at that path that is no folder.
bool is_file(const std::filesystem::path& path);

/// A path as MTL and OBJ files write it, backslashes included, relative to the file that names it.
std::filesystem::path resolve_path(std::string_view name, const std::filesystem::path& named_in);

}  // namespace castray
