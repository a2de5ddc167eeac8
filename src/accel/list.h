#pragma once

#include "accel/triangle.h"

namespace castray {

/// Tests every triangle: for tiny scenes, and what every tree is tested against.
class TriangleList {
 public:
  explicit TriangleList(const MeshView& mesh) : mesh_(mesh) {}

  /// The nearest hit with 0 < t < t_max; of equally near ones that of the lowest triangle.
  template <class T>
  Hit<T> closest(const Ray<T>& ray) const {
    Hit<T> hit;
    if (!is_traceable(ray)) return hit;
    const TriangleTest<T> test(ray);
    for (std::uint32_t i = 0; i < mesh_.count; ++i) intersect_triangle(test, mesh_, i, ray.t_max, hit);
    return hit;
  }

  /// Whether there is any hit with 0 < t < t_max.
  template <class T>
  bool occluded(const Ray<T>& ray) const {
    if (!is_traceable(ray)) return false;
    const TriangleTest<T> test(ray);
    Hit<T> hit;
    for (std::uint32_t i = 0; i < mesh_.count && !hit.found(); ++i) {
      intersect_triangle(test, mesh_, i, ray.t_max, hit);
    }
    return hit.found();
  }

 private:
  MeshView mesh_;
};

}  // namespace castray
