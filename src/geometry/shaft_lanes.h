#pragma once

#include "geometry/facet_records.h"
#include "geometry/wide_bvh_view.h"
#include "simd/vec_lanes.h"

// Visibility between one apex, a point or a direction to infinity, and all points of a box at once: what may
// block is in the shaft, the hull of both. Most shafts are empty.

namespace castray::CASTRAY_ISA {

struct Box {
  float center[3], half[3];
};

inline constexpr int max_blockers = 384;

/// What a box is seen from. Corners and points are relative to `origin`; w is a unit vector.
///
/// From a point, which is the origin, the side planes of pyramids pass through the origin.
struct NearApex {
  Vec origin;

  /// Positive if the plane of a facet with this corner faces away from the apex.
  CASTRAY_INLINE Float above(const Vec& normal, const Vec& corner) const { return dot(normal, corner); }
  /// normal . p of the points of the facet's plane, `normal` turned away from the apex.
  CASTRAY_INLINE Float offset(const Vec& /*normal*/, const Vec& /*corner*/, Float above) const {
    return abs(above);
  }
  /// From the apex to the middle of an edge whose ends have this sum; of any length.
  CASTRAY_INLINE Vec towards(const Vec& sum) const { return sum; }
  /// Shaft::margin of the plane with normal `edge`, which is known to within `error`, through apex and edge;
  /// for points up to `reach` away.
  CASTRAY_INLINE Float margin(const Vec& /*edge*/, const Vec& /*sum*/, Float error,
                              const Vec& /*reach*/) const {
    return error;
  }
};

/// Seen from infinitely far away in direction w: pyramids are prisms along w.
struct FarApex {
  Vec w, origin;

  CASTRAY_INLINE Float above(const Vec& normal, const Vec& /*corner*/) const { return -dot(normal, w); }
  CASTRAY_INLINE Float offset(const Vec& normal, const Vec& corner, Float /*above*/) const {
    return dot(normal, corner);
  }
  CASTRAY_INLINE Vec towards(const Vec& /*sum*/) const { return -w; }
  CASTRAY_INLINE Float margin(const Vec& edge, const Vec& sum, Float error, const Vec& reach) const {
    return fma(error, sum_abs(sum) + sum_abs(reach), dot(edge, sum) * Float(-0.5f));
  }
};

/// Possible blockers between an apex and a box, as pyramids with that apex over facets of three or four
/// corners. Pyramid i hides origin + d if d is inside its side planes, edge . d >= -margin, and behind its
/// base, normal . d > base.
struct Shaft {
  int count = 0;
  alignas(64) float edge[4][3][max_blockers + 16], margin[4][max_blockers + 16];
  alignas(64) float normal[3][max_blockers + 16], base[max_blockers + 16];
};

/// How many packets of triangles, and four times as many nodes, a shaft may hold before a ray for each
/// point of the box is cheaper. A shaft that exceeds it lowers the budget of the next shafts to the same
/// box.
struct ShaftBudget {
  static constexpr int most = max_blockers / packet_size, least = 3;
  int packets = most;

  int nodes() const { return 4 * packets; }
  void gave_up() { packets = packets / 2 > least ? packets / 2 : least; }
  void succeeded(int met) {
    if (met > packets / 2 && packets * 2 <= most) packets *= 2;
  }
};

/// Maximum of a . d over the box; `center` is the box's centre, relative to the origin as d is.
CASTRAY_INLINE Float support(Vec a, Vec center, Vec half) {
  return dot(a, center) + fma(abs(a.x), half.x, fma(abs(a.y), half.y, abs(a.z) * half.z));
}

/// Where a pyramid with these planes (see Shaft) meets the box.
template <int corners>
CASTRAY_INLINE Mask meets_box(const Vec (&edge)[corners], const Float (&margin)[corners], const Vec& normal,
                              Float base, const Vec& center, const Vec& half) {
  Mask meets = support(normal, center, half) > base;
  for (int k = 0; k < corners; ++k)
    meets = meets & (support(edge[k], center, half) + margin[k] >= Float(0.f));
  return meets;
}

/// Numbers of the pyramids that meet a box around origin + center, to `out`; returns how many.
template <int corners>
CASTRAY_INLINE int pyramids_of_part(const Shaft& s, const Vec& center, const Vec& half, uint32_t* out) {
  int n = 0;
  for (int i = 0; i < s.count; i += width) {
    const auto at = [&](const float(&v)[3][max_blockers + 16]) {
      return Vec{load(v[0] + i), load(v[1] + i), load(v[2] + i)};
    };
    Vec edge[corners];
    Float margin[corners];
    for (int k = 0; k < corners; ++k) {
      edge[k] = at(s.edge[k]);
      margin[k] = load(s.margin[k] + i);
    }
    const Mask meets =
        first_lanes(s.count - i) & meets_box(edge, margin, at(s.normal), load(s.base + i), center, half);
    compress_store(out + n, meets, Uint((uint32_t)i) + lane_index());
    n += count(meets);
  }
  return n;
}

/// Where pyramid i hides origin + d.
template <int corners>
CASTRAY_INLINE Mask hides(const Shaft& s, uint32_t i, const Vec& d) {
  Float inside = Float(0.f);
  for (int k = 0; k < corners; ++k) {
    const Vec edge{Float(s.edge[k][0][i]), Float(s.edge[k][1][i]), Float(s.edge[k][2][i])};
    inside = min(inside, dot(edge, d) + Float(s.margin[k][i]));
  }
  const Vec normal{Float(s.normal[0][i]), Float(s.normal[1][i]), Float(s.normal[2][i])};
  return (inside >= Float(0.f)) & (dot(normal, d) > Float(s.base[i]));
}

}  // namespace castray::CASTRAY_ISA
