#pragma once

#include <cstdint>
#include <functional>
#include <limits>

#include "castray/scene.h"
#include "castray/vec.h"

namespace castray {

/// Points origin + t * direction with 0 < t < t_max; `direction` need not be of unit length.
template <class T>
struct Ray {
  Vec3<T> origin, direction;
  T t_max = std::numeric_limits<T>::infinity();
};

/// Where a ray meets triangle (v0,v1,v2): at (1-b1-b2) v0 + b1 v1 + b2 v2.
template <class T>
struct Hit {
  T t = std::numeric_limits<T>::infinity();
  std::uint32_t triangle = Scene::no_index;
  T b1 = 0, b2 = 0;
  std::uint32_t instance = Scene::no_index;  ///< of a scene with instances; see InstanceTree

  bool found() const { return triangle != Scene::no_index; }
};

/// Whether a ray's hit counts; empty: all do. It is asked of hits in any order.
template <class T>
using HitFilter = std::function<bool(const Hit<T>&)>;

/// Triangles as accelerators see them; borrowed, not owned.
struct MeshView {
  const Vec3f* positions = nullptr;
  const Index3* triangles = nullptr;
  std::uint32_t count = 0;
};

/// The triangles in scene space.
inline MeshView mesh_of(const Scene& scene) {
  return {scene.positions.data(), scene.triangles.data(), scene.own_triangles()};
}
/// The triangles of a shared mesh, in its space.
inline MeshView mesh_of(const Scene& scene, const SharedMesh& mesh) {
  return {scene.positions.data(), scene.triangles.data() + mesh.first, mesh.count};
}

}  // namespace castray
