#pragma once

#include "geometry/instance_records.h"
#include "geometry/presence_lanes.h"
#include "geometry/ray_batches.h"
#include "simd/isa_lanes.h"

namespace castray::CASTRAY_ISA {

/// Finds the nearest hit of every ray, and its instance; of equally near ones that of the lowest instance. A
/// `there` that is not null says what of partial triangles counts.
void instances_closest(const InstanceTree& tree, const PartlyThere* there, const RayBatch& rays);

/// Finds whether each ray hits anything that is there.
void instances_occluded(const InstanceTree& tree, const PartlyThere* there, const ShadowBatch& rays);

/// What the windows that rays pass leave of colours.
void instances_tint(const InstanceTree& tree, const PartialTriangles& partial, const TintBatch& rays);

}  // namespace castray::CASTRAY_ISA
