#pragma once

#include "geometry/presence_lanes.h"
#include "geometry/shaft_lanes.h"
#include "geometry/wide_bvh_view.h"

namespace castray::CASTRAY_ISA {

/// The triangles whose pyramids from the apex meet the box (shaft culling: Haines and Wallace 1991). False if
/// they exceed the budget, or if some may be partial: a pyramid has no holes. For AllThere or PartlyThere,
/// and NearApex or FarApex.
template <class Counts, class Apex>
bool triangle_shaft(const WideBvhView& bvh, const Counts& counts, const Apex& apex, const Box& box,
                    ShaftBudget& budget, Shaft& out);

}  // namespace castray::CASTRAY_ISA
