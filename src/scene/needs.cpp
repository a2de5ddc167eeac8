#include "scene/needs.h"

namespace castray {

namespace {

double area_of(const Scene& scene, std::uint32_t triangle) {
  const Index3& t = scene.triangles[triangle];
  const Vec3d v0(scene.positions[t[0]]), v1(scene.positions[t[1]]), v2(scene.positions[t[2]]);
  return length(cross(v1 - v0, v2 - v0)) / 2;
}

double emitting_share(const Scene& scene) {
  double all = 0, emitting = 0;
  if (scene.lights.empty()) return 0;
  for (std::uint32_t i = 0; i < scene.triangles.size(); ++i) all += area_of(scene, i);
  for (const std::uint32_t light : scene.lights) emitting += area_of(scene, light);
  return emitting / all;
}

}  // namespace

SceneNeeds needs_of(const Scene& scene) {
  SceneNeeds needs;
  needs.triangles = scene.triangles.size();
  needs.lights = scene.lights.size();
  needs.smooth_normals = !scene.triangle_normals.empty();
  needs.environment = max_component(scene.environment) > 0;
  needs.emitting_share = emitting_share(scene);
  std::vector<bool> used(scene.materials.size());
  for (const std::uint16_t material : scene.triangle_material) used[material] = true;
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (!used[i]) continue;
    const Material& m = scene.materials[i];
    needs.textures |= m.has_maps() && !scene.triangle_uvs.empty();
    needs.textures |= m.vertex_colors && !scene.triangle_colors.empty();
    needs.types.insert(m.type);
  }
  return needs;
}

}  // namespace castray
