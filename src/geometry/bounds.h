#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

#include "geometry/ray.h"
#include "simd/float4.h"

namespace castray {

/// An axis-aligned box, empty at first, in two vector registers; the fourth lane is free.
struct Bounds {
  Float4 lower{std::numeric_limits<float>::infinity()};
  Float4 upper{-std::numeric_limits<float>::infinity()};

  void add(Float4 point) { add(point, point); }
  void add(Float4 other_lower, Float4 other_upper) {
    lower = min(lower, other_lower);
    upper = max(upper, other_upper);
  }
  void add(const Bounds& other) { add(other.lower, other.upper); }
};

inline Vec3f to_vec3(Float4 v) {
  alignas(16) float lanes[4];
  v.store(lanes);
  return {lanes[0], lanes[1], lanes[2]};
}

/// Half the surface of a box. Zero if it is a point or a segment; meaningless if it is empty.
inline float half_area(const Bounds& box) {
  const Vec3f d = to_vec3(box.upper - box.lower);
  return d.x * d.y + d.y * d.z + d.z * d.x;
}

inline Float4 load_point(const Vec3f& p) { return {p.x, p.y, p.z, 0}; }

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
