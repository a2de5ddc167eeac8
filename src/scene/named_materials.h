#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "scene/json_reader.h"
#include "scene/scene_builder.h"

namespace castray {

/// A scene file's "materials". Textures go to the builder; their paths are relative to `file`.
class NamedMaterials {
 public:
  /// Both must outlive it.
  NamedMaterials(const std::filesystem::path& file, SceneBuilder& builder) : file_(file), builder_(builder) {}

  /// Adds all members of `node` to the scene. A pair may name materials behind it. Throws InputError.
  void read(const JsonNode& node);

  /// The position in Scene::materials of the one that `node` names; `name` is what messages call the value.
  std::uint16_t find(const JsonNode& node, std::string_view name) const;

 private:
  void read_pair(const JsonNode& node);
  std::uint16_t index_of_side(const JsonNode& node, std::string_view pair);
  std::uint16_t emitting_back(std::uint16_t back, const JsonNode& node, std::string_view pair);

  const std::filesystem::path& file_;
  SceneBuilder& builder_;
  std::map<std::string, std::uint16_t> indices_;
};

/// The keys of a material that is another one on each side.
const std::vector<std::string_view>& pair_keys();

}  // namespace castray
