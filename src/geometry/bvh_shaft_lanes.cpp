#include "geometry/bvh_shaft_lanes.h"

#include "geometry/hull_lanes.h"
#include "geometry/pyramids_lanes.h"
#include "simd/octet_lanes.h"

namespace castray::CASTRAY_ISA {

namespace {

inline constexpr int packets_at_once = width > packet_size ? width / packet_size : 1;

/// Adds the triangles of `count` <= packets_at_once packets.
template <class Apex>
CASTRAY_INLINE void add_packets(const TrianglePacket* const (&packets)[packets_at_once], int count,
                                const Apex& apex, const Vec& center, const Vec& half, Shaft& out) {
  constexpr int lanes = width < packet_size ? width : packet_size;
  for (int k = 0; k < packet_size; k += lanes) {
    Vec corner[3];
    for (int v = 0; v < 3; ++v) {
      const auto &first = packets[0]->vertex[v], &last = packets[count - 1]->vertex[v];
      corner[v] = {load_octets(first[0] + k, last[0]), load_octets(first[1] + k, last[1]),
                   load_octets(first[2] + k, last[2])};
    }
    add_pyramids(apex, corner, center, half, first_lanes(count * lanes), out);
  }
}

CASTRAY_INLINE bool has_partial(const AllThere&, const TrianglePacket&) { return false; }
CASTRAY_INLINE bool has_partial(const PartlyThere& there, const TrianglePacket& packet) {
  bool any = false;
  for (const uint32_t triangle : packet.triangle) any |= there.is_partial(triangle);
  return any;
}

}  // namespace

template <class Counts, class Apex>
bool triangle_shaft(const WideBvhView& bvh, const Counts& counts, const Apex& apex, const Box& box,
                    ShaftBudget& budget, Shaft& out) {
  out.count = 0;
  if (bvh.triangles == 0) return true;
  const Vec center = broadcast(box.center), half = broadcast(box.half);
  const float origin[3] = {lane(apex.origin.x, 0), lane(apex.origin.y, 0), lane(apex.origin.z, 0)};
  const Hull hull = hull_of(apex, origin, box);
  uint32_t stack[8 * (4 * ShaftBudget::most + 1)];
  const TrianglePacket* waiting[packets_at_once];
  int size = 0, nodes = 0, packets = 0, to_add = 0;
  stack[size++] = bvh.root;
  while (size > 0) {
    const uint32_t child = stack[--size];
    const char* at = bvh.blocks + (uint64_t)(child / child_unit) * block_bytes;
    if (child & leaf_flag) {
      const int count = (int)(child % max_leaf_packets) + 1;
      if ((packets += count) > budget.packets) return budget.gave_up(), false;
      for (int k = 0; k < count; ++k) {
        const TrianglePacket* packet = (const TrianglePacket*)at + k;
        if (has_partial(counts, *packet)) return false;
        waiting[to_add++] = packet;
        if (to_add < packets_at_once) continue;
        add_packets(waiting, to_add, apex, center, half, out);
        to_add = 0;
      }
      continue;
    }
    if (++nodes > budget.nodes()) return budget.gave_up(), false;
    const WideNode& node = *(const WideNode*)at;
    for (uint32_t inside = children_in_hull(node, origin, hull); inside; inside &= inside - 1)
      stack[size++] = node.child[__builtin_ctz(inside)];
  }
  if (to_add > 0) add_packets(waiting, to_add, apex, center, half, out);
  budget.succeeded(packets);
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
