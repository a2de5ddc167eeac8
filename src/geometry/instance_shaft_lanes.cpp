#include "geometry/instance_shaft_lanes.h"

#include "geometry/instance_lanes.h"
#include "geometry/object_hull_lanes.h"
#include "geometry/shaft_builder_lanes.h"

namespace castray::CASTRAY_ISA {

namespace {

/// A tree's triangles are an instance's object.
struct TreeOfInstance {
  InstanceLanes instance;
  uint32_t first;  ///< triangle of the object

  CASTRAY_INLINE Vec corner(const Vec& v) const {
    return InstanceLanes::product(instance.to_scene, v) + instance.translation;
  }
};

template <class Counts, class Apex>
bool instance_shaft(const InstanceTree& tree, const Counts& counts, const Apex& apex, const Box& box,
                    ShaftBudget& budget, Shaft& out) {
  ShaftBuilder<Counts, Apex> builder(counts, apex, box, budget, out);
  const Hull hull = hull_of(apex, box);
  uint32_t stack[8 * (4 * ShaftBudget::most + 1)];
  int size = 0;
  stack[size++] = tree.top.root;
  while (size > 0) {
    const uint32_t child = stack[--size];
    if (child & leaf_flag) {
      const uint32_t i = child / child_unit;
      const KernelInstance& instance = tree.instances[i];
      const KernelObject& object = tree.objects[instance.object];
      const bool fits = i == tree.plain
                            ? builder.add(object.bvh, hull, TreeInScene())
                            : builder.add(object.bvh, hull_in_object(instance, hull, apex, box),
                                          TreeOfInstance{{tree.instances, Uint(i)}, object.first});
      if (!fits) return false;
      continue;
    }
    if (!builder.visit_node()) return false;
    const WideNode& node = *(const WideNode*)(tree.top.blocks + (uint64_t)(child / child_unit) * block_bytes);
    for (uint32_t inside = children_in_hull(node, hull); inside; inside &= inside - 1)
      stack[size++] = node.child[__builtin_ctz(inside)];
  }
  builder.succeed();
  return true;
}

}  // namespace

template <class Apex>
bool instance_shaft(const InstanceTree& tree, const PartlyThere* there, const Apex& apex, const Box& box,
                    ShaftBudget& budget, Shaft& out) {
  return there ? instance_shaft(tree, *there, apex, box, budget, out)
               : instance_shaft(tree, AllThere{}, apex, box, budget, out);
}

template bool instance_shaft(const InstanceTree&, const PartlyThere*, const NearApex&, const Box&,
                             ShaftBudget&, Shaft&);
template bool instance_shaft(const InstanceTree&, const PartlyThere*, const FarApex&, const Box&,
                             ShaftBudget&, Shaft&);

}  // namespace castray::CASTRAY_ISA
