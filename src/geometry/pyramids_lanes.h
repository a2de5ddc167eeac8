#pragma once

#include "geometry/shaft_lanes.h"

namespace castray::CASTRAY_ISA {

/// Adds the pyramids from an apex over facets, those that meet the box around `center`. All planes are
/// relative to the box, so that they round in proportion to how far facets and box reach from its centre: to
/// the size of a small part that is seen from afar.
template <class Apex, int corners>
CASTRAY_INLINE void add_pyramids(const Apex& apex, const Vec (&corner)[corners], const Vec& center,
                                 const Vec& half, Mask lanes, Shaft& out) {
  const Vec side1 = corner[1] - corner[0], side2 = corner[2] - corner[0], normal = cross(side1, side2);
  Vec from_apex[corners], local[corners];
  for (int k = 0; k < corners; ++k) {
    from_apex[k] = apex.towards(corner[k]);
    local[k] = corner[k] - center;
  }
  const Float above = dot(normal, from_apex[0]);
  const auto away_from_apex = [above](const Vec& v) {
    return Vec{flip_by_sign(v.x, above), flip_by_sign(v.y, above), flip_by_sign(v.z, above)};
  };
  // However the distance from the plane is rounded (8u of the terms), the facet must not hide a point of the
  // box that lies on it.
  const Vec beyond = away_from_apex(normal);
  const Float reach = max_component(half) + max_component(magnitude(local[0]));
  const Float size1 = sum_abs(side1), size2 = sum_abs(side2), size = size1 + size2;
  const Float base = fma(size1 * size2 * reach, Float(0x1p-21f), dot(beyond, local[0]));
  Mask meets = lanes & (dot(magnitude(beyond), half) > base);
  if (none(meets)) return;
  // Bounds of every edge, and of the distances to every corner from points of the box and from the apex.
  const Float from_box = sum_abs(half) + sum_abs(local[0]) + size, distance = sum_abs(from_apex[0]) + size;
  const Float error = distance * size * from_box * Float(0x1p-20f);
  Vec edge[corners];
  Float offset[corners];
  for (int k = 0; k < corners; ++k) {
    const Vec along = corner[(k + 1) % corners] - corner[k];
    edge[k] = away_from_apex(cross(from_apex[k], along));
    offset[k] = -dot(edge[k], local[k]);
    if (k == 3) offset[k] = select(sum_abs(along) > Float(0.f), offset[k], error + error);  // of a triangle
    meets = meets & (dot(magnitude(edge[k]), half) + offset[k] >= -error);
  }
  if (none(meets)) return;
  const int n = out.count;
  const Float scale = Float(1.f) / error;
  for (int k = 0; k < corners; ++k) {
    compress_store(out.edge[k][0] + n, meets, edge[k].x * scale);
    compress_store(out.edge[k][1] + n, meets, edge[k].y * scale);
    compress_store(out.edge[k][2] + n, meets, edge[k].z * scale);
    compress_store(out.offset[k] + n, meets, offset[k] * scale);
  }
  compress_store(out.normal[0] + n, meets, beyond.x);
  compress_store(out.normal[1] + n, meets, beyond.y);
  compress_store(out.normal[2] + n, meets, beyond.z);
  compress_store(out.base + n, meets, base);
  out.count += count(meets);
}

}  // namespace castray::CASTRAY_ISA
