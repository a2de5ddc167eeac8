#pragma once

#include "wavefront/context_lanes.h"

// What the windows that rays pass leave of colours. Rays pass them as often as the colour does that passes
// best (PartialTriangles), and the others are dimmed for it: along rays that hit, and along segments between
// a lamp, or the end of a suffix, and a point.

namespace castray::CASTRAY_ISA {

struct Tints {
  VecArray<capacity> left;  ///< of rays 0 to count - 1; in the rest of the last vector 1
  alignas(64) uint8_t room[capacity];
};

/// Whether some window has a colour.
CASTRAY_INLINE bool has_tints(const Context& c) { return c.scene.geometry.tree.partial.tint; }

/// Of rays o + t d, 0 < t < t_max. `ends`: the surfaces on which they end, which take nothing; or null.
template <class Geometry>
inline __attribute__((noinline)) void find_tints(const Context& c, const VecArray<capacity>& o,
                                                 const VecArray<capacity>& d, const float* t_max, int count,
                                                 const Hits* ends, Tints& out) {
  const Float one(1.f);
  for (int i = 0; i < count; i += width) store(out.left, i, Vec{one, one, one});
  geometry_of<Geometry>(c).tint({o.x, o.y, o.z, d.x, d.y, d.z, t_max, out.room, (uint32_t)count, out.left.x,
                                 out.left.y, out.left.z, ends ? ends->primitive : nullptr,
                                 ends ? ends->instance : nullptr});
}

/// Dims paths by what lies before their hits. `to_be_gathered`: first segments of suffixes, whose ends on
/// surfaces that can be shared send to each pixel along its own segment.
template <class Geometry>
CASTRAY_STAGE void tint(const Context& c, const Hits& hits, bool to_be_gathered, Paths& paths) {
  if (!has_tints(c)) return;
  Tints tints;
  find_tints<Geometry>(c, paths.o, paths.d, hits.t, paths.count, &hits, tints);
  const Geometry geometry = geometry_of<Geometry>(c);
  for (int i = 0; i < paths.count; i += width) {
    Vec left = load(tints.left, i);
    if (to_be_gathered) {
      const Uint found = load(hits.primitive + i);
      const Mask hit = first_lanes(paths.count - i) & ~(found == Uint(no_hit));
      const SurfaceHit at{load(hits.t + i), load(hits.b1 + i), load(hits.b2 + i),
                          select(hit, found, Uint(0u)), select(hit, load(hits.instance + i), Uint(0u))};
      const SurfacePoint x = geometry.surface_point(load(paths.o, i), load(paths.d, i), at);
      const Mask later = hit & has_traits(c.scene, x.material * uint32_t{material_floats}, trait_shareable);
      left = select(later, Vec{Float(1.f), Float(1.f), Float(1.f)}, left);
    }
    store(paths.throughput, i, load(paths.throughput, i) * left);
  }
}

}  // namespace castray::CASTRAY_ISA
