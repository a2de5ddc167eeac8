#pragma once

#include "geometry/geometry_records.h"
#include "simd/isa_lanes.h"

// Which of the hits that a traversal finds count.

namespace castray::CASTRAY_ISA {

/// All of them.
struct AllThere {
  CASTRAY_INLINE bool operator()(uint32_t /*triangle*/, float /*b1*/, float /*b2*/) const { return true; }
};

/// Those on what of the triangles is there in a world.
struct PartlyThere {
  const PartialTriangles& partial;
  uint32_t world;

  CASTRAY_INLINE bool operator()(uint32_t triangle, float b1, float b2) const {
    return !is_partial(triangle) || partial.is_there(partial.self, world, triangle, b1, b2);
  }
  CASTRAY_INLINE bool is_partial(uint32_t triangle) const {
    return partial.triangles[triangle / 32] >> (triangle % 32) & 1;
  }
};

}  // namespace castray::CASTRAY_ISA
