#pragma once

#include "geometry/hull_lanes.h"
#include "geometry/presence_lanes.h"
#include "geometry/pyramids_lanes.h"
#include "simd/octet_lanes.h"

namespace castray::CASTRAY_ISA {

inline constexpr int packets_at_once = width > packet_size ? width / packet_size : 1;

CASTRAY_INLINE bool has_partial(const AllThere&, const TrianglePacket&, uint32_t) { return false; }
/// Triangles of the packet are numbered from `first` on.
CASTRAY_INLINE bool has_partial(const PartlyThere& there, const TrianglePacket& packet, uint32_t first) {
  bool any = false;
  for (const uint32_t triangle : packet.triangle) any |= is_partial(there.partial, first + triangle);
  return any;
}

/// A tree's triangles are in scene space.
struct TreeInScene {
  static constexpr uint32_t first = 0;
  CASTRAY_INLINE Vec corner(const Vec& v) const { return v; }
};

/// Which children of a node are of a closed surface and face the apex at `origin` with all that is below
/// them, with their fronts (`facing` 1) or backs (-1).
CASTRAY_INLINE uint32_t children_facing(const WideNode& node, const float (&origin)[3], float facing) {
  F8 along{}, distance2{}, reach2{};
  const F8 half = splat8(0.5f);
  for (int a = 0; a < 3; ++a) {
    const F8 low = load8(node.lower[a]) - splat8(origin[a]), high = load8(node.upper[a]) - splat8(origin[a]);
    const F8 center = (low + high) * half, reach = (high - low) * half;
    along -= load8(node.normal[a]) * center;
    distance2 += center * center;
    reach2 += reach * reach;
  }
  // For q in the child's box and n in its ball: n . (origin - q) is at least normal . (origin - center) -
  // spread |origin - center| - |q - center|.
  const F8 distance = sqrt8(distance2), reach = sqrt8(reach2);
  const F8 most = load8(node.spread) * distance + reach * splat8(1 / normal_unit);
  const F8 sure = most + (distance + reach) * splat8(0x1p-18f / normal_unit);
  const F8 signed_along = along * splat8(facing);
  return both_less8<false>(sure, signed_along, load8(node.spread), splat8((float)no_surface));
}

/// Which of the triangles face the apex with their fronts (1) or backs (-1), however their normals are
/// rounded.
CASTRAY_INLINE Mask facing_apex(const NearApex& apex, const Vec (&corner)[3], float facing) {
  const Vec side1 = corner[1] - corner[0], side2 = corner[2] - corner[0], from = apex.towards(corner[0]);
  const Float error = sum_abs(side1) * sum_abs(side2) * sum_abs(from) * Float(0x1p-20f);
  return dot(cross(side1, side2), from) * Float(-facing) > error;
}
CASTRAY_INLINE Mask facing_apex(const FarApex&, const Vec (&)[3], float) { return Mask(false); }

/// Gathers the triangles of trees whose pyramids from an apex meet a box.
template <class Counts, class Apex>
class ShaftBuilder {
 public:
  CASTRAY_INLINE ShaftBuilder(const Counts& counts, const Apex& apex, const Box& box, ShaftBudget& budget,
                              Shaft& out, float facing = 0)
      : counts_(counts),
        apex_(apex),
        center_(broadcast(box.center)),
        half_(broadcast(box.half)),
        budget_(budget),
        out_(out),
        origin_{lane(apex.origin.x, 0), lane(apex.origin.y, 0), lane(apex.origin.z, 0)},
        facing_(facing) {
    out.count = 0;
  }

  /// Counts a node; false if there are too many.
  CASTRAY_INLINE bool visit_node() { return ++nodes_ <= budget_.nodes() || (budget_.gave_up(), false); }

  /// False if there are too many triangles or nodes, or if some triangle may be partial. `hull`, `place`: in
  /// the tree's space, and from there to scene space.
  template <class AnyHull, class Place>
  CASTRAY_INLINE bool add(const WideBvhView& bvh, const AnyHull& hull, const Place& place) {
    constexpr int most = 8 * (4 * ShaftBudget::most + 1);
    uint32_t stack[most];
    bool of_surface[most], waiting_of_surface[packets_at_once];
    const TrianglePacket* waiting[packets_at_once];
    int size = 0, to_add = 0;
    of_surface[0] = false;
    stack[size++] = bvh.root;
    while (size > 0) {
      const uint32_t child = stack[--size];
      const char* at = bvh.blocks + (uint64_t)(child / child_unit) * block_bytes;
      if (child & leaf_flag) {
        const int count = (int)(child % max_leaf_packets) + 1;
        if ((packets_ += count) > budget_.packets) return budget_.gave_up(), false;
        for (int k = 0; k < count; ++k) {
          const TrianglePacket* packet = (const TrianglePacket*)at + k;
          if (has_partial(counts_, *packet, place.first)) return false;
          waiting_of_surface[to_add] = of_surface[size];
          waiting[to_add++] = packet;
          if (to_add < packets_at_once) continue;
          add_packets(waiting, waiting_of_surface, to_add, place);
          to_add = 0;
        }
        continue;
      }
      if (!visit_node()) return false;
      const WideNode& node = *(const WideNode*)at;
      uint32_t inside = children_in_hull(node, hull);
      if (facing_ != 0 && inside) inside &= ~children_facing(node, origin_, facing_);
      for (; inside; inside &= inside - 1) {
        const int slot = __builtin_ctz(inside);
        of_surface[size] = facing_ != 0 && node.spread[slot] != no_surface;
        stack[size++] = node.child[slot];
      }
    }
    if (to_add > 0) add_packets(waiting, waiting_of_surface, to_add, place);
    return true;
  }

  CASTRAY_INLINE void succeed() { budget_.succeeded(); }

 private:
  /// Adds the triangles of `count` <= packets_at_once packets.
  template <class Place>
  CASTRAY_INLINE void add_packets(const TrianglePacket* const (&packets)[packets_at_once],
                                  const bool (&of_surface)[packets_at_once], int count, const Place& place) {
    constexpr int lanes = width < packet_size ? width : packet_size;
    for (int k = 0; k < packet_size; k += lanes) {
      Vec corner[3];
      for (int v = 0; v < 3; ++v) {
        const auto &first = packets[0]->vertex[v], &last = packets[count - 1]->vertex[v];
        corner[v] = place.corner({load_octets(first[0] + k, last[0]), load_octets(first[1] + k, last[1]),
                                  load_octets(first[2] + k, last[2])});
      }
      uint32_t surface = 0;
      for (int p = 0; p < count; ++p) surface |= of_surface[p] ? ((1u << lanes) - 1) << (p * lanes) : 0;
      Mask asked = first_lanes(count * lanes);
      if (surface) asked = asked & ~(mask_of_bits(surface) & facing_apex(apex_, corner, facing_));
      add_pyramids(apex_, corner, center_, half_, asked, out_);
    }
  }

  const Counts& counts_;
  const Apex& apex_;
  Vec center_, half_;
  ShaftBudget& budget_;
  Shaft& out_;
  const float origin_[3];
  float facing_;  ///< triangles of a closed surface that face the apex so are left out; 0: none
  int nodes_ = 0, packets_ = 0;
};

}  // namespace castray::CASTRAY_ISA
