#include "castray/scene.h"

#include <algorithm>
#include <limits>

namespace castray {

namespace {

using Box = std::array<Vec3d, 2>;

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr Box empty{Vec3d(infinity), Vec3d(-infinity)};

void add(Box& box, const Vec3d& p) {
  for (int i = 0; i < 3; ++i) {
    box[0][i] = std::min(box[0][i], p[i]);
    box[1][i] = std::max(box[1][i], p[i]);
  }
}

Box bounds_of(const Scene& scene, std::size_t first, std::size_t count) {
  Box box = empty;
  for (std::size_t t = first; t < first + count; ++t)
    for (const std::uint32_t corner : scene.triangles[t]) add(box, Vec3d(scene.positions[corner]));
  return box;
}

}  // namespace

std::size_t Scene::object_of(std::uint32_t triangle) const {
  const auto next = std::ranges::upper_bound(objects, triangle, {}, &SceneObject::first_triangle);
  return static_cast<std::size_t>(next - objects.begin()) - 1;
}

std::uint64_t Scene::shown_triangles() const {
  std::uint64_t shown = own_triangles();
  for (const SceneInstance& instance : instances) shown += shared_meshes[instance.mesh].count;
  return shown;
}

std::array<Vec3d, 2> Scene::bounds() const {
  Box all = bounds_of(*this, 0, own_triangles());
  std::vector<Box> boxes;
  for (const SharedMesh& mesh : shared_meshes) boxes.push_back(bounds_of(*this, mesh.first, mesh.count));
  for (const SceneInstance& instance : instances) {
    const Box& box = boxes[instance.mesh];
    for (std::size_t corner = 0; corner < 8; ++corner) {
      const Vec3d p{box[corner & 1].x, box[corner >> 1 & 1].y, box[corner >> 2].z};
      Vec3d moved;
      for (int i = 0; i < 3; ++i)
        moved[i] = dot(Vec3d(instance.rows[i]), p) + double{instance.translation[i]};
      add(all, moved);
    }
  }
  return all;
}

}  // namespace castray
