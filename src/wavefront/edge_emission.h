#pragma once

#include <cstdint>

#include "castray/render_options.h"
#include "wavefront/kernel_scene.h"

namespace castray {

/// What the camera itself sees of lamps in the pixels on their outlines, by several rays for each sample: a
/// ray is cheap, and which side of such an outline it hits is most of these pixels' noise.
class EdgeEmission {
 public:
  /// Borrows its arguments.
  EdgeEmission(const Scene& scene, const KernelApi& kernel, const KernelSceneData& data, const Window& window,
               const RenderOptions& options);

  /// Whether what is emitted follows from the surface alone, and rays differ between samples.
  bool known() const { return known_; }

  /// The mean over the rays of a sample of pixel (x,y) of the full image.
  Vec3f at(int x, int y, std::uint64_t sample) const;

 private:
  Vec3f emission(const Hit<float>& hit, const Vec3f& direction) const;

  const Scene& scene_;
  const KernelApi& kernel_;
  const KernelSceneData& data_;
  int width_, height_;
  SamplerKind sampler_;
  std::uint64_t seed_;
  bool known_;
};

}  // namespace castray
