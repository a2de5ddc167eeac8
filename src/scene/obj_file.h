#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "scene/mesh.h"
#include "scene/warning_list.h"

namespace castray {

/// The end of a line that names something: a material or files.
struct NamedPlace {
  std::string name;
  SourcePlace place;
};

/// What an OBJ file holds: its polygons cut into triangles, and the names of materials and libraries, which
/// scene/obj_materials.h looks for.
struct ObjFile {
  struct UsedMaterial : NamedPlace {
    bool named = true;      ///< false: of triangles in front of every usemtl
    bool in_front = false;  ///< of every mtllib
  };

  std::filesystem::path path;
  Mesh mesh;  ///< its `triangle_material` is into `materials`
  std::vector<UsedMaterial> materials;
  std::vector<NamedPlace> libraries;     ///< the lines "mtllib"
  std::vector<std::uint32_t> smoothing;  ///< per triangle its smoothing group, 0 for none; or empty
};

/// Reads an OBJ file, or the text that is its content. Warns of what is missing or odd; throws InputError
/// with file, line and column of what is broken.
ObjFile parse_obj(std::string_view text, const std::filesystem::path& file, WarningList& warnings);
ObjFile read_obj(const std::filesystem::path& file, WarningList& warnings);

}  // namespace castray
