#include "materials/brightest_emission.h"

#include <algorithm>

#include "materials/texture.h"

namespace castray {

namespace {

const Texture& texture_of(const Scene& scene, int index) {
  return scene.textures[static_cast<std::size_t>(index)];
}

/// A bound of what an image multiplies a material's emission by, alpha included; at least 1.
double greatest_factor(const Scene& scene, const TextureMap& map) {
  if (!map.used()) return 1;
  const float texel = std::max(greatest_value(texture_of(scene, map.texture)), 1.f);
  return std::max(1.0, map.base + std::max(map.gain, 0.f) * double{texel});
}

}  // namespace

double brightest_emission(const Scene& scene) {
  double brightest = max_component(scene.environment);
  if (const EnvironmentImage& image = scene.environment_image; image.used())
    brightest = std::max(brightest, image.scale * double{greatest_value(texture_of(scene, image.texture))});
  for (const Material& material : scene.materials)
    if (material.emits())
      brightest = std::max(
          brightest, max_component(material.ke) * greatest_factor(scene, material.map(SurfaceParameter::ke)));
  return brightest;
}

}  // namespace castray
