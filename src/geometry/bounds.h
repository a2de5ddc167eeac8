#pragma once

#include <emmintrin.h>

#include <cmath>
#include <cstdint>
#include <limits>

#include "geometry/ray.h"

namespace castray {

/// An axis-aligned box, empty at first, in two vector registers; the fourth lane is free.
struct Bounds {
  __m128 lower = _mm_set1_ps(std::numeric_limits<float>::infinity());
  __m128 upper = _mm_set1_ps(-std::numeric_limits<float>::infinity());

  void add(__m128 point) { add(point, point); }
  void add(__m128 other_lower, __m128 other_upper) {
    lower = _mm_min_ps(lower, other_lower);
    upper = _mm_max_ps(upper, other_upper);
  }
  void add(const Bounds& other) { add(other.lower, other.upper); }
};

inline Vec3f to_vec3(__m128 v) {
  alignas(16) float lanes[4];
  _mm_store_ps(lanes, v);
  return {lanes[0], lanes[1], lanes[2]};
}

/// Half the surface of a box. Zero if it is a point or a segment; meaningless if it is empty.
inline float half_area(const Bounds& box) {
  const Vec3f d = to_vec3(_mm_sub_ps(box.upper, box.lower));
  return d.x * d.y + d.y * d.z + d.z * d.x;
}

inline __m128 load_point(const Vec3f& p) { return _mm_setr_ps(p.x, p.y, p.z, 0); }

inline Bounds triangle_bounds(const MeshView& mesh, std::uint32_t triangle) {
  Bounds box;
  for (const std::uint32_t v : mesh.triangles[triangle]) box.add(load_point(mesh.positions[v]));
  return box;
}

/// Half the surface of ever smaller boxes along a triangle, together: its area seen along each axis.
inline float least_half_area(const MeshView& mesh, std::uint32_t triangle) {
  const Index3& v = mesh.triangles[triangle];
  const Vec3f n =
      cross(mesh.positions[v[1]] - mesh.positions[v[0]], mesh.positions[v[2]] - mesh.positions[v[0]]);
  return (std::abs(n.x) + std::abs(n.y) + std::abs(n.z)) / 2;
}

}  // namespace castray
