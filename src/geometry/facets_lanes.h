#pragma once

#include "geometry/facet_records.h"
#include "geometry/ray_batches.h"
#include "simd/isa_lanes.h"

namespace castray::CASTRAY_ISA {

/// Finds the nearest facet of every ray, and its t; b1 and b2 become 0, and t_max is ignored. `slack`:
/// list_slack for rays that start within the scene; see facet_records.h.
void facets_closest(const FacetList& list, float slack, const RayBatch& rays);

/// Finds whether each segment hits a facet at 0 < t < 1. `slack`: segment_slack.
void facets_occluded(const FacetList& list, float slack, const ShadowBatch& rays);

}  // namespace castray::CASTRAY_ISA
