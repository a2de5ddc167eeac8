#include "geometry/facet_shaft_lanes.h"

#include "geometry/pyramids_lanes.h"

namespace castray::CASTRAY_ISA {

template <class Apex>
bool facet_shaft(const BlockerList& blockers, const Apex& apex, const Box& box, Shaft& out) {
  out.count = 0;
  const Vec center = broadcast(box.center), half = broadcast(box.half);
  for (uint32_t i = 0; i < blockers.count; i += width) {
    if (out.count > max_blockers) return false;
    Vec corner[4];
    for (int k = 0; k < 4; ++k)
      corner[k] = Vec{load(blockers.corner[k][0] + i), load(blockers.corner[k][1] + i),
                      load(blockers.corner[k][2] + i)};
    add_pyramids(apex, corner, center, half, first_lanes((int)(blockers.count - i)), out);
  }
  return true;
}

template bool facet_shaft(const BlockerList&, const NearApex&, const Box&, Shaft&);
template bool facet_shaft(const BlockerList&, const FarApex&, const Box&, Shaft&);

}  // namespace castray::CASTRAY_ISA
