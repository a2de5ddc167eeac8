#pragma once

#include "geometry/presence_lanes.h"
#include "geometry/shaft_lanes.h"
#include "geometry/wide_bvh_view.h"

namespace castray::CASTRAY_ISA {

/// Whether the hull of a point and a box is clear of the rim of the tree's closed surface.
bool clear_of_rim(const WideBvhView& rim, const float (&apex)[3], const Box& box);

/// Triangles that face the apex need no test where the following holds. Let S be a part of the triangles, of
/// which the boundary, its rim, does not meet the hull of the apex and the box, nor that of another point,
/// the camera, and the box. The camera sees all points of the box that count, and one of them, q, is seen
/// from the apex. For any other, p, the closed path camera, q, apex, p, camera bounds a surface inside the
/// two hulls; so it passes through S as often from front to back as from back to front. Only from the apex to
/// p it may pass at all: if S blocks p, a triangle does that faces away, and one that faces the apex.
///
/// The triangles whose pyramids from the apex meet the box (shaft culling: Haines and Wallace 1991). False if
/// they exceed the budget, or if some may be partial: a pyramid has no holes. For AllThere or PartlyThere,
/// and NearApex or FarApex. `facing`: of the tree's closed surface those whose front (1) or back (-1) faces
/// the apex are left out; 0: none.
template <class Counts, class Apex>
bool triangle_shaft(const WideBvhView& bvh, const Counts& counts, const Apex& apex, const Box& box,
                    ShaftBudget& budget, Shaft& out, float facing);

}  // namespace castray::CASTRAY_ISA
