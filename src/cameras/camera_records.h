#pragma once

#include <stdint.h>

namespace castray {

/// Projection, for kernels.
enum KernelProjection : uint32_t { perspective_rays, orthographic_rays, panorama_rays };

/// A thin lens; see Lens.
struct KernelLens {
  float right[3], up[3];      ///< its radii, towards the right and the topmost corner of the aperture
  float inverse_focus;        ///< 1 / Lens::focus_distance
  uint32_t blades;            ///< 0: a disc
  float apothem, half_blade;  ///< of a polygon in a circle of radius 1
};

struct KernelCamera {
  float position[3];
  /// Sample (px,py) of the full image is at corner + px * dx + py * dy: the direction of perspective rays,
  /// the origin of orthographic ones from `position` on.
  float corner[3], dx[3], dy[3];
  uint32_t projection;                ///< KernelProjection
  float forward[3], right[3], up[3];  ///< of orthographic rays and panoramas
  float width, height;                ///< of the full image, in pixels
  bool has_lens;
  KernelLens lens;
};

}  // namespace castray
