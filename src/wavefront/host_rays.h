#pragma once

#include "geometry/ray.h"
#include "wavefront/kernel_scene.h"

// Single rays that the host casts into a scene laid out for the kernels.

namespace castray {

/// The nearest hits of rays: of the list's facets or of a tree's triangles.
void closest_hits(const KernelApi& kernel, const KernelSceneData& data, bool from_camera,
                  const RayBatch& rays);

/// Whether segments between points of the scene hit anything.
void occluded_segments(const KernelApi& kernel, const KernelSceneData& data, const ShadowBatch& rays);

struct SurfaceHit {
  Vec3f normal;
  std::uint32_t material;
};
/// What such a hit is on.
SurfaceHit surface_hit(const Scene& scene, const KernelSceneData& data, const Hit<float>& hit);

}  // namespace castray
