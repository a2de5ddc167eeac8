#pragma once

#include <array>

#include "castray/camera.h"

namespace castray {

/// The camera's ray through pixel (x,y) for the random numbers of its sample's block PathBlocks::camera;
/// `lens` draws those of PathBlocks::lens, where there is one. Without jitter it goes through the pixel's
/// centre.
template <class Draw>
CameraRay camera_sample(const Camera& camera, int x, int y, int width, int height, bool jitter,
                        const std::array<float, 4>& u, const Draw& lens) {
  const std::array<float, 4> on_lens = camera.has_lens() ? lens() : std::array<float, 4>{};
  return camera.ray(x + (jitter ? u[0] : 0.5), y + (jitter ? u[1] : 0.5), width, height, on_lens[0],
                    on_lens[1]);
}

}  // namespace castray
