#pragma once

#include "geometry/facet_records.h"
#include "geometry/ray_batches.h"
#include "simd/vec_lanes.h"

// Rays in lanes against a flat list of facets, each broadcast.
//
// A ray meets a facet if it passes within `slack` of it, more than rounding can displace the computed point:
// so no ray slips between two facets that share an edge or a vertex. Of facets that meet at an outline,
// rounding may then call the wrong one the nearer, and small facets would block too much: what passes so near
// to an edge is settled by the exact test.

namespace castray::CASTRAY_ISA {

struct ListHit {
  Float t;
  Uint facet;
  Float inside;  ///< how far from the facet's nearest edge the ray passes; negative outside
};

inline constexpr float edge_zone = 4;  ///< in units of the slack: within this of an edge, hits are settled

/// Where o + t d meets the facet's plane, and how far inside the facet's nearest edge, seen along the ray.
struct FacetCrossing {
  Float t, inside;
};
template <int axis>
CASTRAY_INLINE FacetCrossing cross_facet(const Facet& f, const Vec& o, const Vec& d) {
  const Vec n = broadcast(f.normal);
  const Float along = dot(n, d), t = (Float(f.offset) - dot(n, o)) / along;
  const Float pu = axis == 0 ? fma(d.y, t, o.y) : axis == 1 ? fma(d.z, t, o.z) : fma(d.x, t, o.x);
  const Float pv = axis == 0 ? fma(d.z, t, o.z) : axis == 1 ? fma(d.x, t, o.x) : fma(d.y, t, o.y);
  Float edge[4];
  for (int k = 0; k < 4; ++k)
    edge[k] = fma(pu, Float(f.edge[k][0]), fma(pv, Float(f.edge[k][1]), Float(f.edge[k][2])));
  const Float nearest = min(min(edge[0], edge[1]), min(edge[2], edge[3]));
  return {t, nearest * abs(along)};
}

template <int axis>
CASTRAY_INLINE void list_closest_of_axis(const FacetList& list, const Vec& o, const Vec& d, Float slack,
                                         ListHit& best) {
  for (uint32_t i = list.first[axis]; i < list.first[axis + 1]; ++i) {
    const FacetCrossing c = cross_facet<axis>(list.facets[i], o, d);
    const Mask closer = (c.inside >= -slack) & (c.t > Float(0.f)) & (c.t < best.t);
    best.t = select(closer, c.t, best.t);
    best.facet = select(closer, Uint(i), best.facet);
    best.inside = select(closer, c.inside, best.inside);
  }
}

/// The hits of `lanes` by the exact test.
[[gnu::noinline, gnu::cold]] inline void settle(const ExactFacets& exact, const Vec& o, const Vec& d,
                                                Mask lanes, ListHit& hit) {
  alignas(64) float t[width];
  alignas(64) uint32_t facet[width];
  store(t, hit.t);
  store(facet, hit.facet);
  for (uint32_t left = bits(lanes); left; left &= left - 1) {
    const int l = __builtin_ctz(left);
    const float origin[3] = {lane(o.x, l), lane(o.y, l), lane(o.z, l)};
    const float direction[3] = {lane(d.x, l), lane(d.y, l), lane(d.z, l)};
    exact.closest(exact.of, origin, direction, t[l], facet[l]);
  }
  hit.t = load(t);
  hit.facet = load(facet);
}

/// The first facet with 0 < t.
CASTRAY_INLINE ListHit list_closest(const FacetList& list, const Vec& o, const Vec& d, Float slack) {
  ListHit best{Float(__builtin_inff()), Uint(no_hit), Float(__builtin_inff())};
  list_closest_of_axis<0>(list, o, d, slack, best);
  list_closest_of_axis<1>(list, o, d, slack, best);
  list_closest_of_axis<2>(list, o, d, slack, best);
  const Mask near_edge = best.inside < slack * Float(edge_zone);
  if (!none(near_edge)) settle(list.exact, o, d, near_edge, best);
  return best;
}

/// How far inside their nearest edge the segments pass facets at 0 < t < 1: the most of `inside` and that of
/// the facets of an axis.
template <int axis>
CASTRAY_INLINE Float list_crossed_by_axis(const FacetList& list, const Vec& o, const Vec& d, Float inside) {
  for (uint32_t i = list.first[axis]; i < list.first[axis + 1]; ++i) {
    const FacetCrossing c = cross_facet<axis>(list.facets[i], o, d);
    const Mask between = (c.t > Float(0.f)) & (c.t < Float(1.f));
    inside = select(between & (c.inside > inside), c.inside, inside);
  }
  return inside;
}

/// Which of `lanes` are blocked by the exact test.
[[gnu::noinline, gnu::cold]] inline Mask settle_blocked(const ExactFacets& exact, const Vec& o, const Vec& d,
                                                        Mask lanes) {
  uint32_t blocked = 0;
  for (uint32_t left = bits(lanes); left; left &= left - 1) {
    const int l = __builtin_ctz(left);
    const float origin[3] = {lane(o.x, l), lane(o.y, l), lane(o.z, l)};
    const float direction[3] = {lane(d.x, l), lane(d.y, l), lane(d.z, l)};
    if (exact.occluded(exact.of, origin, direction)) blocked |= 1u << l;
  }
  return mask_of_bits(blocked);
}

/// Where some facet lies at 0 < t < 1.
CASTRAY_INLINE Mask list_occluded(const FacetList& list, const Vec& o, const Vec& d, Float slack) {
  Float inside = -slack;
  inside = list_crossed_by_axis<0>(list, o, d, inside);
  inside = list_crossed_by_axis<1>(list, o, d, inside);
  inside = list_crossed_by_axis<2>(list, o, d, inside);
  Mask blocked = inside >= slack;
  const Mask near_edge = (inside > -slack) & ~blocked;
  if (!none(near_edge)) blocked = blocked | settle_blocked(list.exact, o, d, near_edge);
  return blocked;
}

}  // namespace castray::CASTRAY_ISA
