#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "scene/mtl_file.h"
#include "scene/obj_file.h"
#include "scene/replaced_materials.h"
#include "scene/scene_builder.h"

namespace castray {

/// The materials that a scene's OBJ files name. Each MTL file is read once, and a material enters the scene
/// when it is used first.
class ObjMaterials {
 public:
  explicit ObjMaterials(SceneBuilder& builder) : builder_(builder) {}

  /// For each of `obj.materials` its position in Scene::materials; `replaced` has those of some names. What
  /// cannot be found is a grey diffuse material, with a warning.
  std::vector<std::uint16_t> find_all(const ObjFile& obj, const ReplacedMaterials& replaced);

 private:
  struct Library {
    MtlFile file;
    std::unordered_map<std::string, std::size_t> names;      ///< as written, and without quotes and escapes
    std::unordered_map<std::string, std::size_t> shortened;  ///< without a comment behind the name
    std::vector<std::optional<std::uint16_t>>
        indices[2];  ///< in the scene, where used; [1]: by meshes with vertex colours
  };
  class Search;

  Library& open(const std::filesystem::path& file);
  std::uint16_t use(Library& library, std::size_t material, bool vertex_colors);
  std::uint16_t default_material(bool vertex_colors);
  std::string not_found(const std::string& name, const Search& search);

  SceneBuilder& builder_;
  std::map<std::filesystem::path, Library> libraries_;
  std::optional<std::uint16_t> default_[2];  ///< [1]: of meshes with vertex colours
  int suggestions_ = 0;
};

}  // namespace castray
