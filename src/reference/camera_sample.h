#pragma once

#include <array>

#include "castray/camera.h"
#include "materials/footprint.h"

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

/// What the pixel sees through the same point of the lens.
template <class T, class Draw>
PixelView<T> pixel_view(const Camera& camera, int x, int y, int width, int height, bool jitter,
                        const std::array<float, 4>& u, const Draw& lens) {
  const std::array<float, 4> on_lens = camera.has_lens() ? lens() : std::array<float, 4>{};
  const auto ray = [&](double right, double down) {
    return camera.ray(x + 0.5 + right, y + 0.5 + down, width, height, on_lens[0], on_lens[1]);
  };
  const CameraRay middle = ray(0, 0), right = ray(1, 0), down = ray(0, 1);
  return {Vec3<T>(middle.origin),
          Vec3<T>(middle.direction),
          Vec3<T>(right.origin - middle.origin),
          Vec3<T>(right.direction - middle.direction),
          Vec3<T>(down.origin - middle.origin),
          Vec3<T>(down.direction - middle.direction),
          {T(jitter ? u[0] : 0.5f), T(jitter ? u[1] : 0.5f)}};
}

}  // namespace castray
