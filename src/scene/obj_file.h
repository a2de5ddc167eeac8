#pragma once

#include <filesystem>
#include <optional>

#include "scene/mesh.h"
#include "scene/scene_builder.h"

namespace castray {

struct ObjOptions {
  std::optional<std::uint16_t> material;  ///< of every triangle; else the file's own, from its MTL files
  bool read_normals = true;               ///< of "vn"
};

/// Reads an OBJ file's polygons, cut into triangles. Its materials are added to the builder; triangles before
/// any "usemtl" get a grey diffuse one. Throws InputError with file and line.
Mesh read_obj(const std::filesystem::path& file, const ObjOptions& options, SceneBuilder& builder);

}  // namespace castray
