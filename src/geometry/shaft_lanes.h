#pragma once

#include "simd/vec_lanes.h"
#include "wavefront/kernel_api.h"

// Visibility of one point to all points of a box at once: the hull of the two is a shaft, and most shafts are
// empty.

namespace castray::CASTRAY_ISA {

struct Box {
  float center[3], half[3];
};

inline constexpr int max_blockers = 384;

/// What may lie between a point y and a box: pyramids with apex y over a facet of three or four corners. A
/// point y + d is hidden by pyramid i if d is inside its side planes, edge . d >= -margin, and beyond its
/// base, normal . d > base.
struct Shaft {
  int count = 0;
  alignas(64) float edge[4][3][max_blockers + 16], margin[4][max_blockers + 16];
  alignas(64) float normal[3][max_blockers + 16], base[max_blockers + 16];
};

/// The greatest a . (x - y) over the box, with y at distance `center` from its middle.
CASTRAY_INLINE Float support(Vec a, Vec center, Vec half) {
  return dot(a, center) + fma(abs(a.x), half.x, fma(abs(a.y), half.y, abs(a.z) * half.z));
}

/// Without fused operations: the exact negative for -b.
CASTRAY_INLINE Vec antisymmetric_cross(Vec a, Vec b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
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

/// Adds the facets with the given corners, relative to y, whose pyramid meets the box; `center` too is
/// relative to y.
template <int corners>
CASTRAY_INLINE void add_pyramids(const Vec (&corner)[corners], const Vec& normal, const Vec& center,
                                 const Vec& half, Mask lanes, Shaft& out) {
  const Float above = dot(normal, corner[0]);
  const Vec beyond{flip_by_sign(normal.x, above), flip_by_sign(normal.y, above),
                   flip_by_sign(normal.z, above)};
  // A point of the box on the facet must not be hidden by it, however its distance from the plane and this
  // one are rounded: 4u of the terms each.
  const Vec size = magnitude(normal), reach = magnitude(center) + half;
  const Float base = fma(dot(size, reach), Float(0x1p-21f), abs(above));
  Vec edge[corners];
  Float margin[corners];
  for (int k = 0; k < corners; ++k) {
    const Vec &from = corner[k], &to = corner[(k + 1) % corners];
    // Twice from x to, rounded in proportion to the edge's length, however near from and to are. For the
    // facet on the edge's other side it is the exact negative: no light passes between the two.
    const Vec sum = from + to, along = to - from, e = antisymmetric_cross(sum, along);
    edge[k] = {flip_by_sign(e.x, above), flip_by_sign(e.y, above), flip_by_sign(e.z, above)};
    margin[k] = sum_abs(sum) * sum_abs(along) * Float(0x1p-21f);
  }
  const Mask meets = lanes & meets_box(edge, margin, beyond, base, center, half);
  if (none(meets)) return;
  const int n = out.count;
  for (int k = 0; k < corners; ++k) {
    compress_store(out.edge[k][0] + n, meets, edge[k].x);
    compress_store(out.edge[k][1] + n, meets, edge[k].y);
    compress_store(out.edge[k][2] + n, meets, edge[k].z);
    compress_store(out.margin[k] + n, meets, margin[k]);
  }
  compress_store(out.normal[0] + n, meets, beyond.x);
  compress_store(out.normal[1] + n, meets, beyond.y);
  compress_store(out.normal[2] + n, meets, beyond.z);
  compress_store(out.base + n, meets, base);
  out.count += count(meets);
}

/// The blockers whose pyramid from y meets the box.
CASTRAY_INLINE void make_shaft(const BlockerList& blockers, const Vec& y, const Box& box, Shaft& out) {
  out.count = 0;
  const Vec center = broadcast(box.center) - y, half = broadcast(box.half);
  for (uint32_t i = 0; i < blockers.count; i += width) {
    Vec corner[4];
    for (int k = 0; k < 4; ++k)
      corner[k] = Vec{load(blockers.corner[k][0] + i), load(blockers.corner[k][1] + i),
                      load(blockers.corner[k][2] + i)} -
                  y;
    const Vec normal{load(blockers.normal[0] + i), load(blockers.normal[1] + i),
                     load(blockers.normal[2] + i)};
    add_pyramids(corner, normal, center, half, first_lanes((int)(blockers.count - i)), out);
  }
}

/// The numbers of the pyramids, in lanes, that meet a box around y + center; returns how many.
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

/// Where pyramid i hides y + d.
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
