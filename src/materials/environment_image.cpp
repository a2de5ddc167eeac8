#include "materials/environment_image.h"

#include <cmath>
#include <numbers>

#include "materials/texture.h"

namespace castray {

namespace {

const Texture& image_of(const Scene& scene) {
  return scene.textures[static_cast<std::size_t>(scene.environment_image.texture)];
}

}  // namespace

double share_of_row(int row, int height) {
  const double step = std::numbers::pi / height;
  return (std::cos(row * step) - std::cos((row + 1) * step)) / 2;
}

std::vector<Vec3f> environment_radiance(const Scene& scene) {
  const Texture& image = image_of(scene);
  const auto count = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
  std::vector<Vec3f> radiance;
  radiance.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const Texel t = texel(image, i);
    radiance.emplace_back(Vec3d(t[0], t[1], t[2]) * scene.environment_image.scale);
  }
  return radiance;
}

Vec3d mean_environment(const Scene& scene) {
  const Texture& image = image_of(scene);
  const std::vector<Vec3f> radiance = environment_radiance(scene);
  Vec3d mean;
  for (std::size_t i = 0; i < radiance.size(); ++i)
    mean += Vec3d(radiance[i]) *
            (share_of_row(static_cast<int>(i / static_cast<std::size_t>(image.width)), image.height) /
             image.width);
  return mean;
}

}  // namespace castray
