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

/// Gathers the triangles of trees whose pyramids from an apex meet a box.
template <class Counts, class Apex>
class ShaftBuilder {
 public:
  CASTRAY_INLINE ShaftBuilder(const Counts& counts, const Apex& apex, const Box& box, ShaftBudget& budget,
                              Shaft& out)
      : counts_(counts),
        apex_(apex),
        center_(broadcast(box.center)),
        half_(broadcast(box.half)),
        budget_(budget),
        out_(out) {
    out.count = 0;
  }

  /// Counts a node; false if there are too many.
  CASTRAY_INLINE bool visit_node() { return ++nodes_ <= budget_.nodes() || (budget_.gave_up(), false); }

  /// False if there are too many triangles or nodes, or if some triangle may be partial. `hull`, `place`: in
  /// the tree's space, and from there to scene space.
  template <class AnyHull, class Place>
  CASTRAY_INLINE bool add(const WideBvhView& bvh, const AnyHull& hull, const Place& place) {
    uint32_t stack[8 * (4 * ShaftBudget::most + 1)];
    const TrianglePacket* waiting[packets_at_once];
    int size = 0, to_add = 0;
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
          waiting[to_add++] = packet;
          if (to_add < packets_at_once) continue;
          add_packets(waiting, to_add, place);
          to_add = 0;
        }
        continue;
      }
      if (!visit_node()) return false;
      for (uint32_t inside = children_in_hull(*(const WideNode*)at, hull); inside; inside &= inside - 1)
        stack[size++] = ((const WideNode*)at)->child[__builtin_ctz(inside)];
    }
    if (to_add > 0) add_packets(waiting, to_add, place);
    return true;
  }

  CASTRAY_INLINE void succeed() { budget_.succeeded(packets_); }

 private:
  /// Adds the triangles of `count` <= packets_at_once packets.
  template <class Place>
  CASTRAY_INLINE void add_packets(const TrianglePacket* const (&packets)[packets_at_once], int count,
                                  const Place& place) {
    constexpr int lanes = width < packet_size ? width : packet_size;
    for (int k = 0; k < packet_size; k += lanes) {
      Vec corner[3];
      for (int v = 0; v < 3; ++v) {
        const auto &first = packets[0]->vertex[v], &last = packets[count - 1]->vertex[v];
        corner[v] = place.corner({load_octets(first[0] + k, last[0]), load_octets(first[1] + k, last[1]),
                                  load_octets(first[2] + k, last[2])});
      }
      add_pyramids(apex_, corner, center_, half_, first_lanes(count * lanes), out_);
    }
  }

  const Counts& counts_;
  const Apex& apex_;
  Vec center_, half_;
  ShaftBudget& budget_;
  Shaft& out_;
  int nodes_ = 0, packets_ = 0;
};

}  // namespace castray::CASTRAY_ISA
