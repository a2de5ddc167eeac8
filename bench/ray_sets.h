#pragma once

#include <string>
#include <vector>

#include "geometry/ray.h"
#include "wavefront/kernel_api.h"

namespace castray {

struct RaySetOptions {
  std::vector<double> camera = {0, 0, 3, 0, 0, 0};  ///< position, point looked at
  double fov = 45;                                  ///< vertical, degrees
  int resolution = 1024;                            ///< pixels of a side
  std::vector<double> quad;                         ///< corner and two edges; empty: a square above the mesh
};

/// Seven numbers a ray (ox oy oz dx dy dz t_max), tile by tile of 8x8 pixels: "primary" through the pixels'
/// centres, "bounce" cosine-distributed from where those hit, "shadow" from there to points of the quad. The
/// same at every call.
std::vector<float> make_rays(const std::string& kind, const MeshView& mesh, const WideBvhView& bvh,
                             const KernelApi& kernel, const RaySetOptions& options);

}  // namespace castray
