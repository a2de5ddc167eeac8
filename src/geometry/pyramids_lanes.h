#pragma once

#include "geometry/shaft_lanes.h"

namespace castray::CASTRAY_ISA {

/// a x b without fused operations, so that swapping a and b negates it exactly.
CASTRAY_INLINE Vec antisymmetric_cross(Vec a, Vec b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// Adds the pyramids over facets, those that meet the box. Corners and `center` are relative to the apex's
/// origin.
template <class Apex, int corners>
CASTRAY_INLINE void add_pyramids(const Apex& apex, const Vec (&corner)[corners], const Vec& normal,
                                 const Vec& center, const Vec& half, Mask lanes, Shaft& out) {
  const Float above = apex.above(normal, corner[0]);
  const Vec beyond{flip_by_sign(normal.x, above), flip_by_sign(normal.y, above),
                   flip_by_sign(normal.z, above)};
  // However distances from the plane are rounded (4u of the terms), the facet must not hide a point of
  // the box that lies on it.
  const Vec size = magnitude(normal), reach = magnitude(center) + half;
  const Float base = fma(dot(size, reach), Float(0x1p-21f), apex.offset(beyond, corner[0], above));
  Vec edge[corners];
  Float margin[corners];
  for (int k = 0; k < corners; ++k) {
    const Vec &from = corner[k], &to = corner[(k + 1) % corners];
    // The normal of the plane through apex and edge (from a point, 2 (from x to)), with error proportional
    // to edge length; swapping corners negates it exactly, so neighbours leave no gap.
    const Vec sum = from + to, along = to - from, towards = apex.towards(sum);
    const Vec e = antisymmetric_cross(towards, along);
    edge[k] = {flip_by_sign(e.x, above), flip_by_sign(e.y, above), flip_by_sign(e.z, above)};
    margin[k] = apex.margin(edge[k], sum, sum_abs(towards) * sum_abs(along) * Float(0x1p-21f), reach);
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
