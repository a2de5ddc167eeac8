#pragma once

#include "wavefront/kernel_scene.h"

// Single rays that the host casts into a scene laid out for the kernels.

namespace castray {

/// The nearest hits of rays: of the list's facets or of the tree's triangles.
void closest_hits(const KernelApi& kernel, const KernelSceneData& data, bool from_camera,
                  const RayBatch& rays);

struct SurfaceHit {
  Vec3f normal;
  std::uint32_t material;
};
/// What such a hit is on.
SurfaceHit surface_hit(const Scene& scene, const KernelSceneData& data, std::uint32_t primitive);

}  // namespace castray
