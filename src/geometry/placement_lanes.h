#pragma once

#include "geometry/instance_lanes.h"

// How what tables hold of triangles is turned to scene space.

namespace castray::CASTRAY_ISA {

/// Triangles are in scene space already.
struct InPlace {
  CASTRAY_INLINE Vec vertex_normal(const Vec& n) const { return n; }
  CASTRAY_INLINE Vec direction(const Vec& v) const { return v; }
  CASTRAY_INLINE Float handedness(Float h) const { return h; }
};

/// Triangles are in the spaces of instances' objects.
struct Placed {
  InstanceLanes instance;

  /// Of other length, on the side that is outward.
  CASTRAY_INLINE Vec normal(const Vec& n) const {
    const auto& rows = instance.to_object;
    return fma(rows[0], n.x, fma(rows[1], n.y, rows[2] * n.z));
  }
  /// Normalised, as those of meshes in scene space are before they are interpolated.
  CASTRAY_INLINE Vec vertex_normal(const Vec& n) const { return normalize(normal(n)); }
  CASTRAY_INLINE Vec direction(const Vec& v) const { return InstanceLanes::product(instance.to_scene, v); }
  /// The sign of a product of three directions.
  CASTRAY_INLINE Float handedness(Float h) const {
    const auto& rows = instance.to_scene;
    return flip_by_sign(h, dot(rows[0], cross(rows[1], rows[2])));
  }
};

}  // namespace castray::CASTRAY_ISA
