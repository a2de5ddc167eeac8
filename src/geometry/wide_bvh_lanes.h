#pragma once

#include "geometry/ray_batches.h"
#include "geometry/wide_bvh_view.h"
#include "simd/isa_lanes.h"

namespace castray::CASTRAY_ISA {

/// Finds the nearest hit of every ray.
void bvh_closest(const WideBvhView& bvh, const RayBatch& rays);

/// Finds whether each ray hits anything.
void bvh_occluded(const WideBvhView& bvh, const ShadowBatch& rays);

}  // namespace castray::CASTRAY_ISA
