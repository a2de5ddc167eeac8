#pragma once

#include "geometry/shaft_lanes.h"
#include "simd/octet_lanes.h"

namespace castray::CASTRAY_ISA {

/// Boxes that touch a hull within rounding count as meeting it.
inline constexpr float hull_slack = 0x1p-20f;

/// A convex region around the hull of an apex and a box: its bounds, and for each pair of axes the two lines
/// from the apex that touch the box. A point p is outside if plane . p > most.
struct Hull {
  float origin[3];  ///< all else is relative to it
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
      hull.plane[hull.planes++] = {a, b, sign * corner[k][1], -sign * corner[k][0], hull_slack};
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
      hull.plane[hull.planes++] = {a, b, x, y, most + hull_slack};
    }
  }
  return hull;
}

/// Which children's boxes meet the hull.
CASTRAY_INLINE uint32_t children_in_hull(const WideNode& node, const Hull& hull) {
  F8 low[3], high[3];
  uint32_t inside = 0xff;
  for (int a = 0; a < 3; ++a) {
    low[a] = load8(node.lower[a]) - splat8(hull.origin[a]);
    high[a] = load8(node.upper[a]) - splat8(hull.origin[a]);
    inside &= both_less8<true>(low[a], splat8(hull.high[a]) + splat8(hull_slack),
                               splat8(hull.low[a]) - splat8(hull_slack), high[a]);
  }
  for (int k = 0; k < hull.planes; ++k) {
    const Hull::Plane& p = hull.plane[k];
    const F8 nearest =
        splat8(p.x) * (p.x > 0 ? low[p.a] : high[p.a]) + splat8(p.y) * (p.y > 0 ? low[p.b] : high[p.b]);
    inside &= both_less8<true>(nearest, splat8(p.most), nearest, splat8(p.most));
  }
  return inside;
}

/// Of an apex and a box.
template <class Apex>
CASTRAY_INLINE Hull hull_of(const Apex& apex, const Box& box) {
  const float origin[3] = {lane(apex.origin.x, 0), lane(apex.origin.y, 0), lane(apex.origin.z, 0)};
  float low[3], high[3];
  for (int a = 0; a < 3; ++a) {
    low[a] = box.center[a] - box.half[a] - origin[a];
    high[a] = box.center[a] + box.half[a] - origin[a];
  }
  Hull hull = make_hull(apex, low, high);
  for (int a = 0; a < 3; ++a) hull.origin[a] = origin[a];
  return hull;
}

}  // namespace castray::CASTRAY_ISA
