#pragma once

#include "geometry/shaft_lanes.h"

namespace castray::CASTRAY_ISA {

/// Without fused operations: the exact negative for -b.
CASTRAY_INLINE Vec antisymmetric_cross(Vec a, Vec b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
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

}  // namespace castray::CASTRAY_ISA
