#pragma once

#include <functional>

#include "generate/shapes.h"
#include "materials/texture.h"
#include "test_scenes.h"

namespace castray::test {

/// Cornell's box with another material on its boxes.
inline Scene box_with(const std::function<void(Material&)>& change) {
  Scene scene = standard_scene("cornell_conductor");
  for (Material& m : scene.materials)
    if (m.type == MaterialType::conductor) change(m);
  return scene;
}

/// Its lamps have sides `times` as long and as much less radiance, lower under the ceiling: what mirrors and
/// glass show of them is found often enough by chance for a z-test.
inline Scene with_larger_lamps(Scene scene, float times) {
  Vec3f middle;
  for (const std::uint32_t light : scene.lights)
    for (const std::uint32_t corner : scene.triangles[light])
      middle += scene.positions[corner] / (3.f * static_cast<float>(scene.lights.size()));
  for (const std::uint32_t light : scene.lights)
    for (std::uint32_t& corner : scene.triangles[light]) {
      const Vec3f p = middle + (scene.positions[corner] - middle) * times - Vec3f(0, 0.05f, 0);
      corner = static_cast<std::uint32_t>(scene.positions.size());
      scene.positions.push_back(p);
    }
  for (Material& m : scene.materials) m.ke = m.ke / double(times * times);
  return scene;
}

/// Textured, with vertex normals that lean by up to `tilt`, as a tangent.
inline Scene with_detail(Scene scene, float tilt = 0.3f) {
  Image checks(2, 2);
  checks.pixels = {{1, 1, 1}, {.2f, .5f, .9f}, {.9f, .4f, .2f}, {.6f, .6f, .6f}};
  scene.textures.push_back(make_texture("checks", checks));
  scene.materials[0].map(SurfaceParameter::kd).texture = 0;
  scene.uvs = {{0, 0}, {2, 0}, {0, 1.5f}};
  for (const Index3& t : scene.triangles) {
    scene.triangle_uvs.push_back({0, 1, 2});
    const auto first = static_cast<std::uint32_t>(scene.normals.size());
    const Vec3f v0 = scene.positions[t[0]], v1 = scene.positions[t[1]], v2 = scene.positions[t[2]];
    const Vec3f n = normalize(cross(v1 - v0, v2 - v0)), lean = normalize(v1 - v0) * tilt;
    scene.normals.insert(scene.normals.end(), {normalize(n + lean), n, normalize(n - lean)});
    scene.triangle_normals.push_back({first, first + 1, first + 2});
  }
  return scene;
}

/// Cornell's box with a hollowed ball of 20 times frequency^2 triangles.
inline Scene box_with_mesh(std::uint32_t frequency = 16, double radius = 100,
                           const Vec3d& middle = {278, 400, 280}) {
  Scene scene = standard_scene("cornell_box");
  const auto first = static_cast<std::uint32_t>(scene.positions.size());
  const Shape ball = blob(frequency, 1);
  for (const Vec3d& p : ball.positions) scene.positions.push_back(Vec3f(scene.to_scene(p * radius + middle)));
  for (const Index3& t : ball.triangles) {
    scene.triangles.push_back({first + t[0], first + t[1], first + t[2]});
    scene.triangle_material.push_back(0);
  }
  return scene;
}

}  // namespace castray::test
