#include "geometry/bvh_shaft_lanes.h"

#include "geometry/shaft_builder_lanes.h"

namespace castray::CASTRAY_ISA {

template <class Counts, class Apex>
bool triangle_shaft(const WideBvhView& bvh, const Counts& counts, const Apex& apex, const Box& box,
                    ShaftBudget& budget, Shaft& out) {
  ShaftBuilder<Counts, Apex> builder(counts, apex, box, budget, out);
  if (bvh.triangles == 0) return true;
  if (!builder.add(bvh, hull_of(apex, box), TreeInScene())) return false;
  builder.succeed();
  return true;
}

template bool triangle_shaft(const WideBvhView&, const AllThere&, const NearApex&, const Box&, ShaftBudget&,
                             Shaft&);
template bool triangle_shaft(const WideBvhView&, const PartlyThere&, const NearApex&, const Box&,
                             ShaftBudget&, Shaft&);
template bool triangle_shaft(const WideBvhView&, const AllThere&, const FarApex&, const Box&, ShaftBudget&,
                             Shaft&);
template bool triangle_shaft(const WideBvhView&, const PartlyThere&, const FarApex&, const Box&, ShaftBudget&,
                             Shaft&);

}  // namespace castray::CASTRAY_ISA
