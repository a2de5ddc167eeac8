#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "scene/obj_materials.h"

namespace castray {

/// Where shading normals come from: the file's "vn", or where it has none its smoothing groups; nowhere; or
/// from the faces around each vertex.
enum class NormalsFrom : std::uint8_t { file, face, smooth };

struct MeshOptions {
  std::optional<std::uint16_t> material;  ///< of every triangle; else the file's own
  ReplacedMaterials materials;            ///< in place of the file's own
  NormalsFrom normals = NormalsFrom::file;
  double crease_angle = 180;  ///< smooth: faces that meet at a greater angle, in degrees, keep their edge
};

/// Gives the mesh the normals that the options ask for. `smoothing` is as in ObjFile.
void choose_normals(Mesh& mesh, const std::vector<std::uint32_t>& smoothing, const MeshOptions& options);

/// The mesh of an OBJ file in a scene. Its materials are added to the scene.
Mesh make_mesh(ObjFile obj, const MeshOptions& options, ObjMaterials& materials);

}  // namespace castray
