#include "integrate/kernel_scene.h"

#include <algorithm>
#include <cmath>

namespace castray {

namespace {

template <class T>
void put(float (&out)[3], const Vec3<T>& v) {
  for (int c = 0; c < 3; ++c) out[c] = static_cast<float>(v[c]);
}

KernelMaterial kernel_material(const Material& m) {
  KernelMaterial k{};
  put(k.kd, m.kd);
  put(k.ks, m.type == MaterialType::conductor ? m.reflectance : m.ks);
  put(k.emission, m.ke);
  k.alpha = static_cast<float>(m.alpha);
  k.ior = static_cast<float>(m.ior);
  k.kind = static_cast<std::uint32_t>(m.type);
  k.two_sided = m.two_sided_emission;
  k.texture = static_cast<std::uint32_t>(m.kd_texture + 1);
  return k;
}

KernelLight facet_light(const Facet& f, const Material& material) {
  KernelLight light{};
  const Vec3d a{f.corner[0][0], f.corner[0][1], f.corner[0][2]},
      b{f.corner[1][0], f.corner[1][1], f.corner[1][2]};
  const Vec3d d{f.corner[3][0], f.corner[3][1], f.corner[3][2]};
  const Vec3d normal = cross(b - a, d - a);
  put(light.origin, a);
  put(light.edge1, b - a);
  put(light.edge2, d - a);
  put(light.normal, normalize(normal));
  put(light.emission, material.ke);
  light.area = static_cast<float>(length(normal));
  light.two_sided = material.two_sided_emission;
  light.error = f.error;
  return light;
}

KernelLight triangle_light(const Facet& f, int first, const Material& material) {
  Facet triangle = f;  // corners first, first + 1, first + 2
  std::copy_n(f.corner[first], 3, triangle.corner[0]);
  std::copy_n(f.corner[(first + 1) % 4], 3, triangle.corner[1]);
  std::copy_n(f.corner[(first + 2) % 4], 3, triangle.corner[3]);
  KernelLight light = facet_light(triangle, material);
  light.area /= 2;
  light.triangle = 1;
  return light;
}

bool is_parallelogram(const Facet& f) {
  double size = 0, gap = 0;
  for (int c = 0; c < 3; ++c) {
    size = std::max<double>(size, std::abs(f.corner[2][c] - f.corner[0][c]));
    gap = std::max(gap, std::abs(double{f.corner[0][c]} + f.corner[2][c] - f.corner[1][c] - f.corner[3][c]));
  }
  return gap <= 1e-6 * size;
}

std::vector<KernelLight> make_lights(const std::vector<Facet>& facets, const Scene& scene) {
  std::vector<KernelLight> lights;
  double total = 0;
  for (const Facet& f : facets) {
    const Material& material = scene.materials[f.material];
    if (!material.emits()) continue;
    if (f.triangle[0] == f.triangle[1]) {
      lights.push_back(triangle_light(f, 0, material));
    } else if (is_parallelogram(f)) {
      lights.push_back(facet_light(f, material));
    } else {
      lights.push_back(triangle_light(f, 0, material));
      lights.push_back(triangle_light(f, 2, material));
    }
  }
  const auto power = [](const KernelLight& l) {
    return double{l.area} * luminance(Vec3d(l.emission[0], l.emission[1], l.emission[2])) *
           (l.two_sided ? 2 : 1);
  };
  for (const KernelLight& l : lights) total += power(l);
  double sum = 0;
  for (KernelLight& l : lights) {
    l.cumulative = static_cast<float>(sum / total);
    sum += power(l);
  }
  for (std::size_t i = 0; i < lights.size(); ++i)  // what the search in the cumulative table really gives
    lights[i].probability = (i + 1 < lights.size() ? lights[i + 1].cumulative : 1.f) - lights[i].cumulative;
  return lights;
}

KernelCamera make_kernel_camera(const Camera& camera, int width, int height) {
  KernelCamera k{};
  const Vec3d corner = camera.direction(0, 0, width, height);
  put(k.position, camera.position);
  put(k.corner, corner);
  put(k.dx, (camera.direction(width, 0, width, height) - corner) / double(width));
  put(k.dy, (camera.direction(0, height, width, height) - corner) / double(height));
  return k;
}

}  // namespace

KernelSceneData::KernelSceneData(const Scene& scene, int width, int height) : facets(make_facets(scene)) {
  for (const Material& m : scene.materials) materials.push_back(kernel_material(m));
  lights = make_lights(facets.facets, scene);
  view.facets = facets.list();
  view.blockers = facets.blocker_list();
  view.blocker_fields = facets.blocker_field_list();
  view.use_list = true;
  view.materials = materials.data();
  view.lights = {lights.data(), static_cast<std::uint32_t>(lights.size())};
  view.camera = make_kernel_camera(scene.camera, width, height);
  put(view.environment, scene.environment);
  view.slack = 0x1p-20f;
  view.camera_slack = static_cast<float>(0x1p-21 * (2 + length(scene.camera.position)));
}

}  // namespace castray
