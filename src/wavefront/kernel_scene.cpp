#include "wavefront/kernel_scene.h"

#include <algorithm>
#include <cmath>

#include "lights/covered_lights.h"

namespace castray {

namespace {

template <class T>
void put(float (&out)[3], const Vec3<T>& v) {
  for (int c = 0; c < 3; ++c) out[c] = static_cast<float>(v[c]);
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
  light.rectangle = std::abs(dot(b - a, d - a)) <= 1e-6 * length(b - a) * length(d - a);
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
  light.rectangle = 0;
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

/// A light's place along a Morton curve through [-1,1]^3, so that a stratified choice among lights is
/// stratified in space.
std::uint64_t place_on_curve(const KernelLight& l) {
  std::uint64_t place = 0;
  for (int c = 0; c < 3; ++c) {
    const double middle = l.origin[c] + (l.edge1[c] + l.edge2[c]) / (l.triangle ? 3.0 : 2.0);
    const auto cell = static_cast<std::uint64_t>(std::clamp((middle + 1) * 0x1p19, 0.0, 0x1p20 - 1));
    for (int bit = 0; bit < 20; ++bit) place |= ((cell >> bit) & 1u) << (3 * bit + c);
  }
  return place;
}

/// The facets that emit: what light sampling places points on.
std::vector<KernelLight> shapes_of_lights(const std::vector<Facet>& facets, const Scene& scene) {
  std::vector<KernelLight> lights;
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
  return lights;
}

double radiance_of(const KernelLight& l) {
  return luminance(Vec3d(l.emission[0], l.emission[1], l.emission[2])) * (l.two_sided ? 2 : 1);
}

/// Lights in an order that keeps neighbours together, with their probabilities by power. Returns the total
/// power / pi.
double finish_lights(std::vector<KernelLight>& lights) {
  std::stable_sort(lights.begin(), lights.end(),
                   [](auto& a, auto& b) { return place_on_curve(a) < place_on_curve(b); });
  double total = 0, sum = 0;
  for (const KernelLight& l : lights) total += double{l.area} * radiance_of(l);
  for (KernelLight& l : lights) {
    l.cumulative = static_cast<float>(sum / total);
    l.density = static_cast<float>(radiance_of(l) / total);
    sum += double{l.area} * radiance_of(l);
  }
  for (std::size_t i = 0; i < lights.size(); ++i)  // what the search in the cumulative table really gives
    lights[i].probability = (i + 1 < lights.size() ? lights[i + 1].cumulative : 1.f) - lights[i].cumulative;
  return total;
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

TriangleTable triangle_table(const Scene& scene, const std::vector<std::uint32_t>& material_words) {
  static_assert(sizeof(Vec3f) == 3 * sizeof(float) && sizeof(Index3) == 3 * sizeof(std::uint32_t));
  TriangleTable table{};
  table.positions = &scene.positions.data()->x;
  table.corners = scene.triangles.data()->data();
  table.materials = material_words.data();
  if (!scene.triangle_normals.empty()) {
    table.normals = &scene.normals.data()->x;
    table.normal_corners = scene.triangle_normals.data()->data();
  }
  if (!scene.triangle_uvs.empty()) {
    table.uvs = scene.uvs.data()->data();
    table.uv_corners = scene.triangle_uvs.data()->data();
  }
  if (!scene.triangle_colors.empty()) {
    table.colors = &scene.colors.data()->x;
    table.color_corners = scene.triangle_colors.data()->data();
  }
  return table;
}

std::vector<std::uint32_t> pack_materials(const Scene& scene) {
  std::vector<std::uint32_t> words((scene.triangle_material.size() + 1) / 2);
  for (std::size_t i = 0; i < scene.triangle_material.size(); ++i)
    words[i / 2] |= std::uint32_t{scene.triangle_material[i]} << (16 * (i % 2));
  return words;
}

}  // namespace

KernelSceneData::KernelSceneData(const Scene& scene, const Plan& plan, int width, int height, int threads)
    : materials(scene) {
  if (plan.list) {
    facets = make_facets(scene);
    lights = shapes_of_lights(facets.facets, scene);
    edges.emplace(scene, facets.facets);
    view.facets = facets.list();
    view.facets.exact = edges->view();
    view.blockers = facets.blocker_list();
    view.blocker_fields = facets.blocker_field_list();
  } else {
    bvh = WideBvh::build(mesh_of(scene), threads, plan.build);
    material_words = pack_materials(scene);
    const std::vector<Facet> emitting = emitting_facets(scene);
    lights = shapes_of_lights(emitting, scene);
    view.lights.may_be_covered = may_be_covered(scene, emitting);
    view.bvh = bvh->view();
    view.triangles = triangle_table(scene, material_words);
  }
  add_lights(scene, plan, threads);
  view.materials = materials.materials.data();
  view.albedos = materials.albedos.data();
  view.details = materials.details.data();
  view.camera = make_kernel_camera(scene.camera, width, height);
  put(view.environment, scene.environment);
  view.camera_slack = static_cast<float>(0x1p-21 * (2 + length(scene.camera.position)));
}

void KernelSceneData::add_lights(const Scene& scene, const Plan& plan, int threads) {
  const double power = finish_lights(lights);
  for (std::size_t i = 0; i < scene.materials.size(); ++i) {
    const Material& m = scene.materials[i];
    if (m.emits())
      materials.materials[i].light_density =
          static_cast<float>(luminance(m.ke) * (m.two_sided_emission ? 2 : 1) / power);
  }
  LightList& list = view.lights;
  list.lights = lights.data();
  list.count = static_cast<std::uint32_t>(lights.size());
  list.by_solid_angle = plan.lights_by_solid_angle;
  if (plan.choose_lights_by_importance && lights.size() > 1) {
    light_tree = LightTree(lights, threads);
    list.cut = light_tree.cut().data();
    list.cut_count = static_cast<std::uint32_t>(light_tree.cut().size());
    list.tree = light_tree.pairs().data();
  }
}

}  // namespace castray
