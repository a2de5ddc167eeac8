#pragma once

#include "kernels/api.h"
#include "kernels/vec.h"

// Rays in lanes against a flat list of facets, each broadcast.
//
// A ray hits a facet if it passes within `slack` of it: the edge test is widened by slack / |cos| along the
// ray, more than rounding can displace the computed point. So no ray slips between two facets that share an
// edge or a vertex.

namespace castray::CASTRAY_ISA {

struct ListHit {
  Float t;
  Uint facet;
};

inline constexpr uint32_t no_hit = 0xffffffffu;

/// Where o + t d meets the facet's plane, and in which lanes that is on the facet.
struct FacetCrossing {
  Float t;
  Mask inside;
};
template <int axis>
CASTRAY_INLINE FacetCrossing cross_facet(const Facet& f, const Vec& o, const Vec& d, Float slack) {
  const Vec n = broadcast(f.normal);
  const Float r = Float(1.f) / dot(n, d);
  const Float t = (Float(f.offset) - dot(n, o)) * r;
  const Float pu = axis == 0 ? fma(d.y, t, o.y) : axis == 1 ? fma(d.z, t, o.z) : fma(d.x, t, o.x);
  const Float pv = axis == 0 ? fma(d.z, t, o.z) : axis == 1 ? fma(d.x, t, o.x) : fma(d.y, t, o.y);
  Float edge[4];
  for (int k = 0; k < 4; ++k)
    edge[k] = fma(pu, Float(f.edge[k][0]), fma(pv, Float(f.edge[k][1]), Float(f.edge[k][2])));
  const Float nearest = min(min(edge[0], edge[1]), min(edge[2], edge[3]));
  return {t, fma(slack, abs(r), nearest) >= Float(0.f)};
}

template <int axis>
CASTRAY_INLINE void list_closest_of_axis(const FacetList& list, const Vec& o, const Vec& d, Float slack,
                                         ListHit& best) {
  for (uint32_t i = list.first[axis]; i < list.first[axis + 1]; ++i) {
    const FacetCrossing c = cross_facet<axis>(list.facets[i], o, d, slack);
    const Mask closer = c.inside & (c.t > Float(0.f)) & (c.t < best.t);
    best.t = select(closer, c.t, best.t);
    best.facet = select(closer, Uint(i), best.facet);
  }
}

/// The first facet with 0 < t.
CASTRAY_INLINE ListHit list_closest(const FacetList& list, const Vec& o, const Vec& d, Float slack) {
  ListHit best{Float(__builtin_inff()), Uint(no_hit)};
  list_closest_of_axis<0>(list, o, d, slack, best);
  list_closest_of_axis<1>(list, o, d, slack, best);
  list_closest_of_axis<2>(list, o, d, slack, best);
  return best;
}

template <int axis>
CASTRAY_INLINE Mask list_occluded_by_axis(const FacetList& list, const Vec& o, const Vec& d, Float slack) {
  Mask blocked(false);
  for (uint32_t i = list.first[axis]; i < list.first[axis + 1]; ++i) {
    const FacetCrossing c = cross_facet<axis>(list.facets[i], o, d, slack);
    blocked = blocked | (c.inside & (c.t > Float(0.f)) & (c.t < Float(1.f)));
  }
  return blocked;
}

/// Where some facet lies at 0 < t < 1.
CASTRAY_INLINE Mask list_occluded(const FacetList& list, const Vec& o, const Vec& d, Float slack) {
  return list_occluded_by_axis<0>(list, o, d, slack) | list_occluded_by_axis<1>(list, o, d, slack) |
         list_occluded_by_axis<2>(list, o, d, slack);
}

}  // namespace castray::CASTRAY_ISA
