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

/// Where a point is seen in the image.
struct SeenPoint {
  Float px, py;
  /// Area of the image, in pixels, over the solid angle in which the camera sees it; 0 behind the camera.
  Float pixels_per_solid_angle;
};

/// `towards`: from the camera to the point.
CASTRAY_INLINE SeenPoint see_point(const KernelCamera& camera, Vec towards) {
  const Vec corner = broadcast(camera.corner), dx = broadcast(camera.dx), dy = broadcast(camera.dy);
  const Vec across = cross(dx, dy);
  const Float scale = dot(across, corner) / dot(across, towards);
  const Vec d = towards * scale, in_plane = d - corner;
  const Float length2 = length_squared(d);
  const Float density = length2 * sqrt(length2) / abs(dot(across, d));
  return {dot(in_plane, dx) / length_squared(dx), dot(in_plane, dy) / length_squared(dy),
          select(scale > Float(0.f), density, Float(0.f))};
}

}  // namespace castray::CASTRAY_ISA
