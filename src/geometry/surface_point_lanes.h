#pragma once

#include "simd/vec_lanes.h"

namespace castray::CASTRAY_ISA {

/// A closest hit: ray parameter, facet or triangle, and barycentrics of a triangle.
struct SurfaceHit {
  Float t, b1, b2;
  Uint primitive, instance;  ///< the latter has no meaning without an InstanceTree
};

/// A point on a surface. `normal` is geometric, to the counter-clockwise side. `error` bounds the
/// distance of p from the exact surface: ray origins are offset by it. `material` is an index.
struct SurfacePoint {
  Vec p, normal;
  Float error;
  Uint material;
};

}  // namespace castray::CASTRAY_ISA
