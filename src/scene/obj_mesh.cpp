#include "scene/obj_mesh.h"

#include <algorithm>

#include "scene/smooth_normals.h"

namespace castray {

namespace {

void set_materials(Mesh& mesh, const std::vector<std::uint16_t>& indices) {
  for (std::uint16_t& material : mesh.triangle_material) material = indices[material];
}

}  // namespace

void choose_normals(Mesh& mesh, const std::vector<std::uint32_t>& smoothing, const MeshOptions& options) {
  const bool from_groups = mesh.triangle_normals.empty() && !smoothing.empty();
  if (options.normals == NormalsFrom::smooth)
    smooth_normals(mesh, {}, options.crease_angle);
  else if (options.normals == NormalsFrom::file && from_groups)
    smooth_normals(mesh, smoothing, 180);
  else if (options.normals == NormalsFrom::face)
    mesh.normals.clear(), mesh.triangle_normals.clear();
}

Mesh make_mesh(ObjFile obj, const MeshOptions& options, ObjMaterials& materials) {
  if (options.material)
    std::ranges::fill(obj.mesh.triangle_material, *options.material);
  else
    set_materials(obj.mesh, materials.find_all(obj, options.materials));
  choose_normals(obj.mesh, obj.smoothing, options);
  return std::move(obj.mesh);
}

}  // namespace castray
