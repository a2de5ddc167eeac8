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

  /// Corners times `scale`, moved by `offset`; `inwards`: the sides that the normals point to are swapped.
  void add_mesh(const std::vector<Vec3d>& positions, const std::vector<Index3>& triangles, double scale,
                const Vec3d& offset, bool inwards, std::uint16_t material) {
    const auto first = static_cast<std::uint32_t>(scene.positions.size());
    for (const Vec3d& p : positions) scene.positions.emplace_back(p * scale + offset);
    for (const Index3& t : triangles)
      add_triangle({first + t[0], first + t[inwards ? 2 : 1], first + t[inwards ? 1 : 2]}, material);
  }

  /// A closed cube of half the side `half`.
  void add_cube(double half, const Vec3d& middle, bool inwards, std::uint16_t material) {
    std::vector<Vec3d> corners;
    for (int i = 0; i < 8; ++i) corners.push_back({i & 1 ? 1. : -1., i & 2 ? 1. : -1., i & 4 ? 1. : -1.});
    static const std::vector<Index3> faces = {{0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5},
                                              {0, 1, 5}, {0, 5, 4}, {2, 6, 7}, {2, 7, 3},
                                              {0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}};
    add_mesh(corners, faces, half, middle, inwards, material);
  }

 private:
  void add_triangle(const Index3& corners, std::uint16_t material) {
    if (scene.emits(material)) scene.lights.push_back(static_cast<std::uint32_t>(scene.triangles.size()));
    scene.triangles.push_back(corners);
    scene.triangle_material.push_back(material);
  }
};

/// The default integrator on one thread, a square image.
inline RenderOptions wavefront_options(int side, std::uint64_t spp, std::uint64_t seed) {
  RenderOptions options;
  options.width = options.height = side;
  options.spp = spp;
  options.seed = seed;
  options.threads = 1;
  return options;
}

/// Without shared paths.
inline RenderOptions plain(RenderOptions options) {
  options.reuse = {.automatic = false};
  return options;
}

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
