#include "geometry/bvh_shaft_lanes.h"

#include "geometry/shaft_builder_lanes.h"

namespace castray::CASTRAY_ISA {

bool clear_of_rim(const WideBvhView& rim, const float (&apex)[3], const Box& box) {
  if (rim.triangles == 0) return true;
  const Hull hull = hull_of(NearApex{broadcast(apex)}, box);
  uint32_t* const stack = (uint32_t*)__builtin_alloca((7u * (uint32_t)rim.depth + 9) * sizeof(uint32_t));
  int size = 0;
  stack[size++] = rim.root;
  while (size > 0) {
    const uint32_t child = stack[--size];
    if (child & leaf_flag) return false;
    const WideNode& node = *(const WideNode*)(rim.blocks + (uint64_t)(child / child_unit) * block_bytes);
    for (uint32_t inside = children_in_hull(node, hull); inside; inside &= inside - 1)
      stack[size++] = node.child[__builtin_ctz(inside)];
  }
  return true;
}

template <class Counts, class Apex>
bool triangle_shaft(const WideBvhView& bvh, const Counts& counts, const Apex& apex, const Box& box,
                    ShaftBudget& budget, Shaft& out, float facing) {
  ShaftBuilder<Counts, Apex> builder(counts, apex, box, budget, out, facing);
  if (bvh.triangles == 0) return true;
  if (!builder.add(bvh, hull_of(apex, box), TreeInScene())) return false;
  builder.succeed();
  return true;
}

template bool triangle_shaft(const WideBvhView&, const AllThere&, const NearApex&, const Box&, ShaftBudget&,
                             Shaft&, float);
template bool triangle_shaft(const WideBvhView&, const PartlyThere&, const NearApex&, const Box&,
                             ShaftBudget&, Shaft&, float);
template bool triangle_shaft(const WideBvhView&, const AllThere&, const FarApex&, const Box&, ShaftBudget&,
                             Shaft&, float);
template bool triangle_shaft(const WideBvhView&, const PartlyThere&, const FarApex&, const Box&, ShaftBudget&,
                             Shaft&, float);

}  // namespace castray::CASTRAY_ISA
