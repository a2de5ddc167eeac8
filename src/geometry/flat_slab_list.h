#pragma once

#include <algorithm>

#include "geometry/list.h"

namespace castray {

/// Fault vanishing_boxes: each triangle behind a test of its own bounding box that asks for t_min < t_max.
/// The box of an axis-aligned triangle is flat, both are equal there, and the triangle is never seen.
template <class T>
class FlatSlabList {
 public:
  explicit FlatSlabList(const MeshView& mesh) : mesh_(mesh) {}

  Hit<T> closest(const Ray<T>& ray, const HitFilter<T>& counts) const {
    Hit<T> hit;
    const TriangleTest<T> test(ray);
    for (std::uint32_t i = 0; i < mesh_.count; ++i)
      if (meets_box(ray, mesh_.triangles[i])) intersect_triangle(test, mesh_, i, ray.t_max, counts, hit);
    return hit;
  }

  bool occluded(const Ray<T>& ray, const HitFilter<T>& counts) const { return closest(ray, counts).found(); }

 private:
  bool meets_box(const Ray<T>& ray, const Index3& t) const {
    const Vec3<T> v0(mesh_.positions[t[0]]), v1(mesh_.positions[t[1]]), v2(mesh_.positions[t[2]]);
    T t_min = 0, t_max = ray.t_max;
    for (int axis = 0; axis < 3; ++axis) {
      const auto [low, high] = std::minmax({v0[axis], v1[axis], v2[axis]});
      const T a = (low - ray.origin[axis]) / ray.direction[axis];
      const T b = (high - ray.origin[axis]) / ray.direction[axis];
      t_min = std::max(t_min, std::min(a, b));
      t_max = std::min(t_max, std::max(a, b));
    }
    return t_min < t_max;
  }

  MeshView mesh_;
};

}  // namespace castray
