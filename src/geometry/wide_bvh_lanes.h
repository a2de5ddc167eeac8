#pragma once

#include "geometry/presence_lanes.h"
#include "geometry/ray_batches.h"
#include "geometry/wide_bvh_view.h"
#include "simd/isa_lanes.h"

namespace castray::CASTRAY_ISA {

/// Finds the nearest hit of every ray; of partial triangles what is there counts.
void bvh_closest(const WideBvhView& bvh, const RayBatch& rays);
void bvh_closest(const WideBvhView& bvh, const PartlyThere& there, const RayBatch& rays);

/// Finds whether each ray hits anything that is there, or what of its light partial triangles leave.
void bvh_occluded(const WideBvhView& bvh, const ShadowBatch& rays);
void bvh_occluded(const WideBvhView& bvh, const PartlyThere& there, const ShadowBatch& rays);

/// What the windows that rays pass leave of colours.
void bvh_tint(const WideBvhView& bvh, const PartialTriangles& partial, const TintBatch& rays);

}  // namespace castray::CASTRAY_ISA
