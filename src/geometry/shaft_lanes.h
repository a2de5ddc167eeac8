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

/// What a box is seen from: a point.
struct NearApex {
  Vec origin;

  /// From the apex to a corner.
  CASTRAY_INLINE Vec towards(const Vec& corner) const { return corner - origin; }
};

/// Infinitely far away, in the direction of unit vector w: pyramids are prisms along w. Hulls are computed
/// relative to `origin`, a place near the box.
struct FarApex {
  Vec w, origin;

  CASTRAY_INLINE Vec towards(const Vec& /*corner*/) const { return -w; }
};

/// Possible blockers between an apex and a box, as pyramids with that apex over facets of three or four
/// corners. Places are relative to the box's centre. A pyramid hides p if p is inside its side planes,
/// edge . p + offset >= 0, and behind its base, normal . p > base. Sides are scaled so that rounding is less
/// than 1.
struct Shaft {
  int count = 0;
  alignas(64) float edge[4][3][max_blockers + 16], offset[4][max_blockers + 16];
  alignas(64) float normal[3][max_blockers + 16], base[max_blockers + 16];
};

/// How many packets of triangles, and four times as many nodes, a shaft may hold before a ray for each
/// point of the box is cheaper. A shaft that exceeds it halves the budget of the next shafts to the same box,
/// one that does not doubles it again.
struct ShaftBudget {
  static constexpr int most = max_blockers / packet_size, least = 3;
  int packets = most;

  int nodes() const { return 4 * packets; }
  void gave_up() { packets = packets / 2 > least ? packets / 2 : least; }
  void succeeded() { packets = packets * 2 < most ? packets * 2 : most; }
};

/// Numbers of the pyramids that meet a part of the box, to `out`; returns how many. `center`: the part's,
/// relative to the box's.
template <int corners>
CASTRAY_INLINE int pyramids_of_part(const Shaft& s, const Vec& center, const Vec& half, uint32_t* out) {
  int n = 0;
  for (int i = 0; i < s.count; i += width) {
    const auto support = [&](const float(&plane)[3][max_blockers + 16]) {
      const Vec a{load(plane[0] + i), load(plane[1] + i), load(plane[2] + i)};
      return dot(a, center) + dot(magnitude(a), half);
    };
    Mask meets = first_lanes(s.count - i) & (support(s.normal) > load(s.base + i));
    for (int k = 0; k < corners; ++k)
      meets = meets & (support(s.edge[k]) + load(s.offset[k] + i) >= Float(-1.f));
    compress_store(out + n, meets, Uint((uint32_t)i) + lane_index());
    n += count(meets);
  }
  return n;
}

/// How far inside the sides of pyramid i each p lies that is behind its base, in units of rounding: hidden
/// from 1 on, not hidden below -1; between the two only a ray can tell. -infinity if p is not behind the
/// base.
template <int corners>
CASTRAY_INLINE Float hidden_by(const Shaft& s, uint32_t i, const Vec& p) {
  Float inside(__builtin_inff());
  for (int k = 0; k < corners; ++k)
    inside =
        min(inside,
            fma(Float(s.edge[k][0][i]), p.x,
                fma(Float(s.edge[k][1][i]), p.y, fma(Float(s.edge[k][2][i]), p.z, Float(s.offset[k][i])))));
  const Vec normal{Float(s.normal[0][i]), Float(s.normal[1][i]), Float(s.normal[2][i])};
  return select(dot(normal, p) > Float(s.base[i]), inside, Float(-__builtin_inff()));
}

}  // namespace castray::CASTRAY_ISA
