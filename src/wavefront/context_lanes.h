#pragma once

#include "wavefront/wave_lanes.h"

namespace castray::CASTRAY_ISA {

/// The scene, what is asked, and the running count of rays, as all stages get them.
struct Context {
  const KernelScene& scene;
  const KernelOptions& options;
  const TileJob& job;
  const FarEnds& ends;
  uint64_t rays = 0;
};

}  // namespace castray::CASTRAY_ISA
