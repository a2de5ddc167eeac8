#pragma once

#include "geometry/facet_records.h"
#include "geometry/shaft_lanes.h"

namespace castray::CASTRAY_ISA {

/// The blockers whose pyramids from y meet the box.
void facet_shaft(const BlockerList& blockers, const Vec& y, const Box& box, Shaft& out);

}  // namespace castray::CASTRAY_ISA
