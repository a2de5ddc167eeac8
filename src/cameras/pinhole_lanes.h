#pragma once

#include "cameras/camera_records.h"
#include "simd/vec_lanes.h"

namespace castray::CASTRAY_ISA {

/// A camera ray; d is not of unit length.
struct CameraRay {
  Vec o, d;
};

/// Of sample (px,py) of the full image. It needs no lens sample: see PathBlocks::lens.
CASTRAY_INLINE CameraRay camera_ray(const KernelCamera& camera, Float px, Float py) {
  return {broadcast(camera.position),
          fma(broadcast(camera.dx), px, fma(broadcast(camera.dy), py, broadcast(camera.corner)))};
}

}  // namespace castray::CASTRAY_ISA
