#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "castray/scene.h"

namespace castray {

/// An object of the scene file and the keys it may have; scenes/castray.schema.json has the same.
struct SceneSection {
  std::string_view name;
  std::vector<std::string_view> keys;
};
const std::vector<SceneSection>& scene_sections();

/// Reads a scene file, or the text that is its content. Throws InputError with the place of the first error.
Scene parse_scene(std::string_view text, const std::filesystem::path& file);
Scene read_scene_file(const std::filesystem::path& file);

}  // namespace castray
