#pragma once

#include "geometry/hull_lanes.h"
#include "geometry/instance_records.h"

namespace castray::CASTRAY_ISA {

/// A Hull as an instance's object sees it: as a linear map has it, with rounding added. A point q is outside
/// if plane . q > most, or if it is outside the bounds.
struct ObjectHull {
  float low[3], high[3];
  int planes = 0;
  struct Plane {
    float x[3], most;
  } plane[12];
};

/// Where in the object's space the scene's box of this centre and half sides is, to `low` and `high`.
CASTRAY_INLINE void add_box(const KernelInstance& instance, const float* center, const float* half,
                            ObjectHull& hull) {
  for (int i = 0; i < 3; ++i) {
    float middle = 0, reach = 0, size = 0;
    for (int k = 0; k < 3; ++k) {
      const float entry = instance.to_object[i][k], most = entry < 0 ? -entry : entry;
      middle += entry * (center[k] - instance.translation[k]);
      reach += most * half[k];
      size += most * (__builtin_fabsf(center[k]) + half[k] + __builtin_fabsf(instance.translation[k]));
    }
    reach += size * hull_slack;
    hull.low[i] = middle - reach < hull.low[i] ? middle - reach : hull.low[i];
    hull.high[i] = middle + reach > hull.high[i] ? middle + reach : hull.high[i];
  }
}

CASTRAY_INLINE void add_bounds(const KernelInstance& instance, const NearApex& apex, const Box& box,
                               ObjectHull& hull) {
  const float origin[3] = {lane(apex.origin.x, 0), lane(apex.origin.y, 0), lane(apex.origin.z, 0)};
  const float point[3] = {};
  add_box(instance, origin, point, hull);
  add_box(instance, box.center, box.half, hull);
}
/// A hull without end is bounded by its planes alone.
CASTRAY_INLINE void add_bounds(const KernelInstance&, const FarApex&, const Box&, ObjectHull& hull) {
  for (int i = 0; i < 3; ++i) {
    hull.low[i] = -__builtin_inff();
    hull.high[i] = __builtin_inff();
  }
}

/// Adds normal . (p - origin) <= most of scene space, where a point's coordinates in the object's are at most
/// 1.
CASTRAY_INLINE void add_plane(const KernelInstance& instance, const float* origin, const float (&normal)[3],
                              float most, ObjectHull& hull) {
  if (!(most < __builtin_inff())) return;
  ObjectHull::Plane& plane = hull.plane[hull.planes++];
  float size = 0;
  for (int k = 0; k < 3; ++k) {
    float x = 0;
    for (int a = 0; a < 3; ++a) x += normal[a] * instance.to_scene[a][k];
    plane.x[k] = x;
    most += normal[k] * (origin[k] - instance.translation[k]);
    size += __builtin_fabsf(normal[k]) *
            (__builtin_fabsf(origin[k]) + __builtin_fabsf(instance.translation[k]) +
             __builtin_fabsf(instance.to_scene[k][0]) + __builtin_fabsf(instance.to_scene[k][1]) +
             __builtin_fabsf(instance.to_scene[k][2]));
  }
  plane.most = most + size * hull_slack;
}

template <class Apex>
CASTRAY_INLINE ObjectHull hull_in_object(const KernelInstance& instance, const Hull& hull, const Apex& apex,
                                         const Box& box) {
  ObjectHull out;
  for (int a = 0; a < 3; ++a) {
    out.low[a] = __builtin_inff();
    out.high[a] = -__builtin_inff();
  }
  add_bounds(instance, apex, box, out);
  for (int a = 0; a < 3; ++a) {
    float normal[3] = {};
    normal[a] = 1;
    add_plane(instance, hull.origin, normal, hull.high[a] + hull_slack, out);
    normal[a] = -1;
    add_plane(instance, hull.origin, normal, hull_slack - hull.low[a], out);
  }
  for (int k = 0; k < hull.planes; ++k) {
    const Hull::Plane& p = hull.plane[k];
    float normal[3] = {};
    normal[p.a] = p.x;
    normal[p.b] = p.y;
    add_plane(instance, hull.origin, normal, p.most, out);
  }
  return out;
}

/// Which children's boxes meet the hull.
CASTRAY_INLINE uint32_t children_in_hull(const WideNode& node, const ObjectHull& hull) {
  F8 low[3], high[3];
  uint32_t inside = 0xff;
  for (int a = 0; a < 3; ++a) {
    low[a] = load8(node.lower[a]);
    high[a] = load8(node.upper[a]);
    inside &= both_less8<true>(low[a], splat8(hull.high[a]), splat8(hull.low[a]), high[a]);
  }
  for (int k = 0; k < hull.planes; ++k) {
    const ObjectHull::Plane& p = hull.plane[k];
    F8 nearest = splat8(p.x[0]) * (p.x[0] > 0 ? low[0] : high[0]);
    for (int a = 1; a < 3; ++a) nearest = nearest + splat8(p.x[a]) * (p.x[a] > 0 ? low[a] : high[a]);
    inside &= both_less8<true>(nearest, splat8(p.most), nearest, splat8(p.most));
  }
  return inside;
}

}  // namespace castray::CASTRAY_ISA
