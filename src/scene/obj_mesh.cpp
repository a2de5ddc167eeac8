#include "scene/obj_mesh.h"

#include <algorithm>

#include "scene/smooth_normals.h"

namespace castray {

namespace {

void set_materials(Mesh& mesh, const std::vector<std::uint16_t>& indices) {
  for (std::uint16_t& material : mesh.triangle_material) material = indices[material];
}

void set_normals(ObjFile& obj, const MeshOptions& options) {
  Mesh& mesh = obj.mesh;
  const bool from_groups = mesh.triangle_normals.empty() && !obj.smoothing.empty();
  if (options.normals == NormalsFrom::smooth)
    smooth_normals(mesh, {}, options.crease_angle);
  else if (options.normals == NormalsFrom::file && from_groups)
    smooth_normals(mesh, obj.smoothing, 180);
  else if (options.normals == NormalsFrom::face)
    mesh.normals.clear(), mesh.triangle_normals.clear();
}

}  // namespace

Mesh make_mesh(ObjFile obj, const MeshOptions& options, ObjMaterials& materials) {
  if (options.material)
    std::ranges::fill(obj.mesh.triangle_material, *options.material);
  else
    set_materials(obj.mesh, materials.find_all(obj));
  set_normals(obj, options);
  return std::move(obj.mesh);
}

}  // namespace castray
