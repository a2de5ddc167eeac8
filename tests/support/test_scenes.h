#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "castray/render.h"
#include "castray/scene.h"

namespace castray::test {

inline Scene standard_scene(const std::string& name) {
  return load_scene(std::filesystem::path(CASTRAY_ROOT) / "scenes" / (name + ".json"));
}

/// A scene put together by a test, in the test's own coordinates. The camera is Scene's default until set.
class SceneSketch {
 public:
  Scene scene;

  std::uint16_t add_material(const Material& material) {
    scene.materials.push_back(material);
    return static_cast<std::uint16_t>(scene.materials.size() - 1);
  }

  /// Corners counter-clockwise as seen from the side that the normal points to.
  void add_quad(const Vec3f& a, const Vec3f& b, const Vec3f& c, const Vec3f& d, std::uint16_t material) {
    const auto first = static_cast<std::uint32_t>(scene.positions.size());
    scene.positions.insert(scene.positions.end(), {a, b, c, d});
    add_triangle({first, first + 1, first + 2}, material);
    add_triangle({first, first + 2, first + 3}, material);
  }

 private:
  void add_triangle(const Index3& corners, std::uint16_t material) {
    if (scene.materials[material].emits())
      scene.lights.push_back(static_cast<std::uint32_t>(scene.triangles.size()));
    scene.triangles.push_back(corners);
    scene.triangle_material.push_back(material);
  }
};

/// The reference integrator at a size, with independent random numbers.
inline RenderOptions reference_options(int width, int height, std::uint64_t spp, std::uint64_t seed = 1) {
  RenderOptions options;
  options.integrator = Integrator::reference;
  options.sampler = SamplerKind::independent;
  options.width = width;
  options.height = height;
  options.spp = spp;
  options.seed = seed;
  return options;
}

}  // namespace castray::test
