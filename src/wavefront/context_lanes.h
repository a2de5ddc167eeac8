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
  /// By slot, 1: emission that the path finds after a specular lobe is left to light paths. Null: none is.
  uint32_t* left_to_light_paths = nullptr;
  uint64_t rays = 0, gathered = 0, evaluated = 0;  ///< as in TileResult
};

template <class Geometry>
CASTRAY_INLINE Geometry geometry_of(const Context& c) {
  return Geometry(c.scene.geometry, c.world);
}

}  // namespace castray::CASTRAY_ISA
