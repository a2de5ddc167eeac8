#pragma once

#include "geometry/facet_records.h"
#include "geometry/ray_batches.h"
#include "simd/isa_lanes.h"

namespace castray::CASTRAY_ISA {

/// Finds the nearest facet of every ray, and t; b1 and b2 are 0, and t_max is not looked at. The closest hit
/// of the tiles' kernels over lists (list.h) by itself, for tests. `slack` as in api.h.
void facets_closest(const FacetList& list, float slack, const RayBatch& rays);

/// Finds whether each ray hits any facet at 0 < t < 1.
void facets_occluded(const FacetList& list, float slack, const ShadowBatch& rays);

}  // namespace castray::CASTRAY_ISA
