#pragma once

#include "geometry/instance_records.h"
#include "geometry/presence_lanes.h"
#include "geometry/shaft_lanes.h"

namespace castray::CASTRAY_ISA {

/// As triangle_shaft, of all that instances show and what is in scene space. `there`: as for
/// instances_closest.
template <class Apex>
bool instance_shaft(const InstanceTree& tree, const PartlyThere* there, const Apex& apex, const Box& box,
                    ShaftBudget& budget, Shaft& out);

}  // namespace castray::CASTRAY_ISA
