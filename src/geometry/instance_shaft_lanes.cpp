#include "geometry/instance_shaft_lanes.h"

#include "geometry/bvh_shaft_lanes.h"
#include "geometry/hull_lanes.h"

namespace castray::CASTRAY_ISA {

namespace {

/// Whether nothing but what is in scene space may be in the hull.
CASTRAY_INLINE bool holds_plain_alone(const InstanceTree& tree, const float* origin, const Hull& hull) {
  uint32_t stack[8 * 96];  // no tree is deeper
  int size = 0;
  stack[size++] = tree.top.root;
  while (size > 0) {
    const uint32_t child = stack[--size];
    if (child & leaf_flag) {
      if (child / child_unit != tree.plain) return false;
      continue;
    }
    const WideNode& node = *(const WideNode*)(tree.top.blocks + (uint64_t)(child / child_unit) * block_bytes);
    for (uint32_t inside = children_in_hull(node, origin, hull); inside; inside &= inside - 1)
      stack[size++] = node.child[__builtin_ctz(inside)];
  }
  return true;
}

}  // namespace

template <class Apex>
bool instance_shaft(const InstanceTree& tree, const PartlyThere* there, const Apex& apex, const Box& box,
                    ShaftBudget& budget, Shaft& out) {
  const float origin[3] = {lane(apex.origin.x, 0), lane(apex.origin.y, 0), lane(apex.origin.z, 0)};
  if (!holds_plain_alone(tree, origin, hull_of(apex, origin, box))) return false;
  out.count = 0;
  if (tree.plain == tree.count) return true;
  const WideBvhView& plain = tree.objects[tree.instances[tree.plain].object].bvh;
  return there ? triangle_shaft(plain, *there, apex, box, budget, out)
               : triangle_shaft(plain, AllThere{}, apex, box, budget, out);
}

template bool instance_shaft(const InstanceTree&, const PartlyThere*, const NearApex&, const Box&,
                             ShaftBudget&, Shaft&);
template bool instance_shaft(const InstanceTree&, const PartlyThere*, const FarApex&, const Box&,
                             ShaftBudget&, Shaft&);

}  // namespace castray::CASTRAY_ISA
