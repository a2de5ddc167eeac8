#pragma once

#include "wavefront/wave_lanes.h"

namespace castray::CASTRAY_ISA {

/// What every stage gets: scene, options, job, and the count of rays traced.
struct Context {
  const KernelScene& scene;
  const KernelOptions& options;
  const TileJob& job;
  const FarEnds& ends;
  uint32_t world;  ///< of PartialTriangles: one for each sample of the image
  /// By slot, 1: emission that the path finds by way of a specular lobe, or of a surface that focuses, is
  /// left to light paths. Null: none is.
  uint32_t* left_to_light_paths = nullptr;
  uint64_t rays = 0, gathered = 0, asked = 0, evaluated = 0;  ///< as in TileResult
};

/// The materials' records of vertices i to i + width - 1; 0 past the last.
CASTRAY_INLINE Uint records_of(const Vertices& v, int i) {
  return select(first_lanes(v.count - i), record_of(load(v.material + i)), Uint(0u));
}

/// Whether points of a material gather from what a tile shares. Beyond all others a path of the pixel's own
/// goes on.
CASTRAY_INLINE Mask gathers(const KernelScene& scene, Uint record) {
  return has_traits(scene, record, trait_shareable) & ~has_traits(scene, record, trait_focuses);
}

/// Whether light that lamps send to a surface that focuses, as a vertex of the path in `slot`, is left to
/// light paths.
CASTRAY_INLINE Mask leaves_lamps(const Context& c, Uint slot, Uint record) {
  if (!c.left_to_light_paths) return Mask(false);
  return has_traits(c.scene, record, trait_focuses) & (gather(c.left_to_light_paths, slot) == Uint(1u));
}

/// The same of vertices i to i + width - 1.
CASTRAY_INLINE Mask leaves_lamps(const Context& c, const Vertices& v, int i) {
  const Mask active = first_lanes(v.count - i);
  return active & leaves_lamps(c, select(active, load(v.names.slot + i), Uint(0u)), records_of(v, i));
}

template <class Geometry>
CASTRAY_INLINE Geometry geometry_of(const Context& c) {
  return Geometry(c.scene.geometry, c.world);
}

}  // namespace castray::CASTRAY_ISA
