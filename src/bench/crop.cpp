#include "bench/crop.h"

#include <algorithm>

namespace castray {

namespace {

/// Sums over the pixels of `window` of the relative squared errors of all pictures.
double disagreement(const BenchScene& scene, const PixelMask& mask, const Window& window) {
  double sum = 0;
  for (int y = window.y0; y < window.y1; ++y) {
    for (int x = window.x0; x < window.x1; ++x) {
      const auto pixel =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(scene.width) + static_cast<std::size_t>(x);
      if (!mask.empty() && !mask[pixel]) continue;
      const Vec3d reference(scene.reference_image.pixels[pixel]);
      for (const BenchCurve& curve : scene.curves) {
        if (!curve.equal_time) continue;
        const Vec3d error = Vec3d(curve.equal_time->image.pixels[pixel]) - reference;
        sum += dot(error, error) / (dot(reference, reference) + 0.03);
      }
    }
  }
  return sum;
}

}  // namespace

Window worst_window(const BenchScene& scene, const PixelMask& mask) {
  const int side = std::max(1, std::min({scene.width, scene.height, std::max(scene.width / 4, 32)}));
  const int step = std::max(1, side / 2);
  Window worst;
  double most = -1;
  for (int y = 0; y + side <= scene.height; y += step) {
    for (int x = 0; x + side <= scene.width; x += step) {
      const Window window{scene.width, scene.height, x, y, x + side, y + side};
      const double sum = disagreement(scene, mask, window);
      if (sum > most) most = sum, worst = window;
    }
  }
  return worst;
}

Image cropped(const Image& image, const Window& window) {
  Image result(window.width(), window.height());
  for (int y = 0; y < result.height; ++y)
    for (int x = 0; x < result.width; ++x) result.at(x, y) = image.at(window.x0 + x, window.y0 + y);
  return result;
}

}  // namespace castray
