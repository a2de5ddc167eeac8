#pragma once

#include "wavefront/wave_lanes.h"

namespace castray::CASTRAY_ISA {

/// What every stage gets: scene, options, job, and the count of rays traced.
struct Context {
  const KernelScene& scene;
  const KernelOptions& options;
  const TileJob& job;
  const FarEnds& ends;
  uint64_t rays = 0;
};

}  // namespace castray::CASTRAY_ISA
