#pragma once

#include "simd/vec_lanes.h"

namespace castray::CASTRAY_ISA {

/// What a closest-hit search found: ray parameter, facet or triangle, and barycentrics of a triangle.
struct SurfaceHit {
  Float t, b1, b2;
  Uint primitive;
};

/// A point on a surface: `normal` is the geometric one, to the counter-clockwise side; `error` bounds the
/// distance of `p` from the exact surface, and is how far a ray origin must be offset; `material` is an
/// index.
struct SurfacePoint {
  Vec p, normal;
  Float error;
  Uint material;
};

}  // namespace castray::CASTRAY_ISA
