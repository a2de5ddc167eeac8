#include "castray/scene.h"

#include <algorithm>

#include "core/box.h"

namespace castray {

namespace {

Box3d bounds_of(const Scene& scene, std::size_t first, std::size_t count) {
  Box3d box;
  for (std::size_t t = first; t < first + count; ++t)
    for (const std::uint32_t corner : scene.triangles[t]) box.add(Vec3d(scene.positions[corner]));
  return box;
}

}  // namespace

std::size_t Scene::object_of(std::uint32_t triangle) const {
  const auto next = std::ranges::upper_bound(objects, triangle, {}, &SceneObject::first_triangle);
  return static_cast<std::size_t>(next - objects.begin()) - 1;
}

std::vector<std::uint16_t> Scene::emitting_sides(std::uint16_t material) const {
  std::vector<std::uint16_t> sides;
  if (materials[material].emits()) sides.push_back(material);
  if (const std::uint16_t back = on_side(material, false); back != material && materials[back].emits())
    sides.push_back(back);
  return sides;
}

std::vector<bool> Scene::used_materials() const {
  std::vector<bool> used(materials.size());
  for (const std::uint16_t material : triangle_material) used[material] = true;
  for (std::size_t m = 0; m < used.size(); ++m)
    if (used[m]) {
      used[on_side(static_cast<std::uint16_t>(m), false)] = true;
      if (materials[m].has_glass()) used[static_cast<std::size_t>(materials[m].glass)] = true;
    }
  return used;
}

std::uint64_t Scene::shown_triangles() const {
  std::uint64_t shown = own_triangles();
  for (const SceneInstance& instance : instances) shown += shared_meshes[instance.mesh].count;
  return shown;
}

std::array<Vec3d, 2> Scene::bounds() const {
  Box3d all = bounds_of(*this, 0, own_triangles());
  std::vector<Box3d> boxes;
  for (const SharedMesh& mesh : shared_meshes) boxes.push_back(bounds_of(*this, mesh.first, mesh.count));
  for (const SceneInstance& instance : instances)
    for (const Vec3d& corner : boxes[instance.mesh].corners()) all.add(instance.point(corner));
  return {all.lower, all.upper};
}

}  // namespace castray
