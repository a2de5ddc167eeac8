#pragma once

#include <array>
#include <cstdint>

#include "castray/scene.h"

namespace castray {

/// The corners of a triangle in scene space.
struct TriangleCorners {
  Vec3d a, b, c;

  /// The normal, as long as twice the area.
  Vec3d twice_area() const { return cross(b - a, c - a); }
  Vec3d middle() const { return (a + b + c) / 3; }
  std::array<Vec3d, 3> all() const { return {a, b, c}; }
};

inline TriangleCorners corners_of(const Scene& scene, std::uint32_t triangle) {
  const Index3& t = scene.triangles[triangle];
  return {Vec3d(scene.positions[t[0]]), Vec3d(scene.positions[t[1]]), Vec3d(scene.positions[t[2]])};
}

}  // namespace castray
