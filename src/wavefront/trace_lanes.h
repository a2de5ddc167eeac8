#pragma once

#include "wavefront/context_lanes.h"
#include "wavefront/radiance_lanes.h"
#include "wavefront/tint_lanes.h"

namespace castray::CASTRAY_ISA {

/// The nearest hit of each path's ray. `presence`: what of partial triangles is there for it.
template <class Geometry>
CASTRAY_INLINE void closest(Context& c, const Paths& paths, bool from_camera, Hits& hits,
                            const PresenceNumbers& presence = {}) {
  c.rays += (uint64_t)paths.count;
  geometry_of<Geometry>(c).closest(
      {paths.o.x, paths.o.y, paths.o.z, paths.d.x, paths.d.y, paths.d.z, c.ends.infinite, hits.t,
       hits.primitive, hits.b1, hits.b2, (uint32_t)paths.count, hits.instance, presence},
      from_camera);
}

/// Adds the radiance of unoccluded shadow rays, as far as partial triangles leave it.
template <class Geometry>
CASTRAY_INLINE void add_unblocked(Context& c, ShadowRays& rays, Radiance& radiance) {
  c.rays += (uint64_t)rays.count;
  const Geometry geometry = geometry_of<Geometry>(c);
  float* const kept = geometry.thins() ? rays.kept : nullptr;
  geometry.occluded({rays.o.x, rays.o.y, rays.o.z, rays.d.x, rays.d.y, rays.d.z, c.ends.one, rays.blocked,
                     (uint32_t)rays.count, kept});
  for (int i = 0; kept && i < rays.count; i += width)
    store(rays.radiance, i, load(rays.radiance, i) * load(kept + i));
  if (has_tints(c)) {
    Tints tints;
    find_tints<Geometry>(c, rays.o, rays.d, c.ends.one, rays.count, nullptr, tints);
    for (int i = 0; i < rays.count; i += width)
      store(rays.radiance, i, load(rays.radiance, i) * load(tints.left, i));
  }
  for (int i = 0; i < rays.count; ++i) {
    if (rays.blocked[i]) continue;
    radiance.x[rays.slot[i]] += rays.radiance.x[i];
    radiance.y[rays.slot[i]] += rays.radiance.y[i];
    radiance.z[rays.slot[i]] += rays.radiance.z[i];
  }
}

}  // namespace castray::CASTRAY_ISA
