#pragma once

#include "geometry/facet_records.h"
#include "geometry/shaft_lanes.h"

namespace castray::CASTRAY_ISA {

/// The blockers whose pyramids from the apex meet the box. False: they are more than a shaft holds. For
/// NearApex and FarApex.
template <class Apex>
bool facet_shaft(const BlockerList& blockers, const Apex& apex, const Box& box, Shaft& out);

}  // namespace castray::CASTRAY_ISA
