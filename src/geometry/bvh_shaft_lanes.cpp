#include "geometry/bvh_shaft_lanes.h"

#include "geometry/pyramids_lanes.h"
#include "simd/octet_lanes.h"

namespace castray::CASTRAY_ISA {

namespace {

/// Boxes that touch a hull within rounding count as meeting it.
constexpr float slack = 0x1p-20f;

/// A convex region around the hull of an apex and a box: its bounds, and for each pair of axes the two lines
/// from the apex that touch the box. A point p is outside if plane . p > most.
struct Hull {
  float low[3], high[3];
  int planes = 0;
  struct Plane {
    int a, b;    ///< axes
    float x, y;  ///< the normal's components along them
    float most;  ///< slack included
  } plane[6];
};

/// `low` and `high`: the box, relative to the apex.
CASTRAY_INLINE Hull make_hull(const NearApex&, const float* low, const float* high) {
  Hull hull;
  for (int a = 0; a < 3; ++a) {
    hull.low[a] = low[a] < 0 ? low[a] : 0;
    hull.high[a] = high[a] > 0 ? high[a] : 0;
  }
  for (int a = 0; a < 3; ++a) {
    const int b = a == 2 ? 0 : a + 1;
    const float corner[4][2] = {{low[a], low[b]}, {high[a], low[b]}, {low[a], high[b]}, {high[a], high[b]}};
    for (int k = 0; k < 4; ++k) {
      float least = 0, most = 0;
      for (int j = 0; j < 4; ++j) {
        const float side = corner[k][0] * corner[j][1] - corner[k][1] * corner[j][0];
        least = side < least ? side : least;
        most = side > most ? side : most;
      }
      if (least < 0 && most > 0) continue;
      if (hull.planes == 6) break;
      const float sign = least < 0 ? -1.f : 1.f;
      hull.plane[hull.planes++] = {a, b, sign * corner[k][1], -sign * corner[k][0], slack};
    }
  }
  return hull;
}

/// The box, swept to infinity along w.
CASTRAY_INLINE Hull make_hull(const FarApex& apex, const float* low, const float* high) {
  const float w[3] = {lane(apex.w.x, 0), lane(apex.w.y, 0), lane(apex.w.z, 0)};
  Hull hull;
  for (int a = 0; a < 3; ++a) {
    const int b = a == 2 ? 0 : a + 1;
    hull.low[a] = w[a] < 0 ? -__builtin_inff() : low[a];
    hull.high[a] = w[a] > 0 ? __builtin_inff() : high[a];
    for (float sign = -1; sign <= 1; sign += 2) {
      const float x = sign * w[b], y = -sign * w[a];
      const float most = x * (x > 0 ? high[a] : low[a]) + y * (y > 0 ? high[b] : low[b]);
      hull.plane[hull.planes++] = {a, b, x, y, most + slack};
    }
  }
  return hull;
}

/// Which children's boxes meet the hull, whose origin is at `origin`.
CASTRAY_INLINE uint32_t children_in_hull(const WideNode& node, const float* origin, const Hull& hull) {
  F8 low[3], high[3];
  uint32_t inside = 0xff;
  for (int a = 0; a < 3; ++a) {
    low[a] = load8(node.lower[a]) - splat8(origin[a]);
    high[a] = load8(node.upper[a]) - splat8(origin[a]);
    inside &= both_less8<true>(low[a], splat8(hull.high[a]) + splat8(slack),
                               splat8(hull.low[a]) - splat8(slack), high[a]);
  }
  for (int k = 0; k < hull.planes; ++k) {
    const Hull::Plane& p = hull.plane[k];
    const F8 nearest =
        splat8(p.x) * (p.x > 0 ? low[p.a] : high[p.a]) + splat8(p.y) * (p.y > 0 ? low[p.b] : high[p.b]);
    inside &= both_less8<true>(nearest, splat8(p.most), nearest, splat8(p.most));
  }
  return inside;
}

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
  float low[3], high[3];
  for (int a = 0; a < 3; ++a) {
    low[a] = box.center[a] - box.half[a] - origin[a];
    high[a] = box.center[a] + box.half[a] - origin[a];
  }
  const Hull hull = make_hull(apex, low, high);
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
