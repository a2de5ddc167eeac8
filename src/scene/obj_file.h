#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

#include "scene/mesh.h"
#include "scene/scene_builder.h"

namespace castray {

struct ObjOptions {
  std::optional<std::uint16_t> material;  ///< of every triangle; else the file's own, from its MTL files
  bool read_normals = true;               ///< of "vn"
};

/// Reads the polygons of an OBJ file, or of the text that is its content, cut into triangles. Its materials
/// are added to the builder; triangles before any "usemtl" get a grey diffuse one. Throws InputError with
/// file and line.
Mesh parse_obj(std::string_view text, const std::filesystem::path& file, const ObjOptions& options,
               SceneBuilder& builder);
Mesh read_obj(const std::filesystem::path& file, const ObjOptions& options, SceneBuilder& builder);

}  // namespace castray
