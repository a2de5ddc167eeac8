#include "wavefront/kernel_scene.h"

#include "cameras/camera.h"
#include "lights/covered_lights.h"
#include "lights/delta_lights.h"
#include "lights/mirrored_lights.h"
#include "materials/descriptor.h"
#include "materials/surface_values.h"

namespace castray {

namespace {

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

/// Whether light gets into some body: then a point may be seen from within it, and another from outside.
bool transmits(const Scene& scene) {
  return std::ranges::any_of(scene.materials,
                             [](const Material& m) { return (traits_of(m) & trait_transmits) != 0; });
}

bool has_emission_images(const Scene& scene) {
  return !scene.triangle_uvs.empty() && std::ranges::any_of(scene.materials, &Material::has_emission_map);
}

PartialTriangles partial_triangles(const Coverage& coverage, const CoverageCells& cells, BuildQuality build) {
  const auto share_there = [](const void* self, const PartialHit& hit) {
    const Vec3f direction(hit.direction[0], hit.direction[1], hit.direction[2]);
    return static_cast<const Coverage*>(self)->share_there(
        Hit<float>{0, hit.triangle, hit.b1, hit.b2, hit.instance}, direction);
  };
  const auto tint = [](const void* self, const PartialHit& hit, float* red, float* green, float* blue) {
    const Vec3f direction(hit.direction[0], hit.direction[1], hit.direction[2]);
    const Vec3f left = static_cast<const Coverage*>(self)->tint(
        Hit<float>{0, hit.triangle, hit.b1, hit.b2, hit.instance}, direction);
    *red *= left.x, *green *= left.y, *blue *= left.z;
  };
  void (*const tints)(const void*, const PartialHit&, float*, float*, float*) = tint;
  return {coverage.partial_triangles(), share_there,  &coverage,     coverage.tints() ? tints : nullptr,
          build != BuildQuality::best,  cells.side(), cells.grids(), cells.cells()};
}

std::vector<std::uint32_t> pack_materials(const Scene& scene) {
  std::vector<std::uint32_t> words((scene.triangle_material.size() + 1) / 2);
  for (std::size_t i = 0; i < scene.triangle_material.size(); ++i)
    words[i / 2] |= std::uint32_t{scene.triangle_material[i]} << (16 * (i % 2));
  return words;
}

}  // namespace

KernelSceneData::KernelSceneData(const Scene& scene, const Plan& plan, int width, int height, int threads)
    : coverage(scene),
      coverage_cells(scene),
      materials(scene),
      environment(scene),
      deltas(kernel_deltas(scene.delta_lights)) {
  if (plan.list) {
    facets = make_facets(scene);
    lights = LightTable(scene, facets.facets, plan.choose_lights_by_importance, threads);
    view.lights = lights.list();
    edges.emplace(scene, facets.facets);
    view.geometry.list.facets = facets.list();
    view.geometry.list.facets.exact = edges->view();
    view.geometry.list.blockers = facets.blocker_list();
    view.geometry.list.blockers.exact = edges->view();
    view.geometry.list.blocker_fields = facets.blocker_field_list();
  } else {
    if (scene.instances.empty()) {
      build_tree(scene, plan.build, threads);
    } else {
      instances = InstanceBvh::build(scene, threads, plan.build);
      view.geometry.instances = instances->view();
    }
    material_words = pack_materials(scene);
    const std::vector<Facet> emitting = emitting_facets(scene);
    lights = LightTable(scene, emitting, plan.choose_lights_by_importance, threads);
    view.lights = lights.list();
    view.lights.may_be_covered = may_be_covered(scene, emitting);
    view.geometry.tree.triangles = triangle_table(scene, material_words);
    view.geometry.tree.partial = partial_triangles(coverage, coverage_cells, plan.build);
  }
  if (plan.light_paths) mirrored = mirrored_lights(scene, lights.lights());
  view.lights.mirrored = {mirrored.data(), static_cast<int>(mirrored.size())};
  view.lights.by_solid_angle = plan.lights_by_solid_angle;
  view.lights.environment = environment.table();
  view.lights.deltas = {deltas.data(), static_cast<std::uint32_t>(deltas.size())};
  const std::vector<Vec3d> emission = mean_emissions(scene);
  for (std::size_t i = 0; i < scene.materials.size(); ++i)
    materials.materials[i].light_density = lights.density(scene.materials[i], emission[i]);
  if (has_emission_images(scene)) {
    view.lights.materials = &view;
    view.lights.triangles = &view.geometry.tree.triangles;
  }
  static_cast<MaterialTables&>(view) = materials.tables();
  look_through(view, scene.camera, width, height);
}

void KernelSceneData::build_tree(const Scene& scene, BuildQuality quality, int threads) {
  const MeshView mesh = mesh_of(scene);
  const bool opaque = !coverage.partial_triangles() && !transmits(scene);
  const ClosedSurface surface = opaque ? closed_surface(mesh, threads) : ClosedSurface{};
  const bool has_surface = std::ranges::find(surface.has, true) != surface.has.end();
  bvh = WideBvh::build(mesh, threads, quality, has_surface ? &surface : nullptr);
  rim = WideBvh::build({mesh.positions, surface.rim.data(), static_cast<std::uint32_t>(surface.rim.size())},
                       threads);
  view.geometry.tree.bvh = bvh->view();
  view.geometry.tree.has_surface = has_surface;
  view.geometry.tree.rim = rim->view();
}

void look_through(KernelScene& view, const Camera& camera, int width, int height) {
  view.camera = kernel_camera(camera, width, height);
  view.geometry.list.camera_slack =
      static_cast<float>(0x1p-21 * (2 + farthest_origin(camera, width, height)));
}

void KernelSceneData::use(LightRegionTable regions, const Scene& scene) {
  if (is_list())
    lights.use(std::move(regions), facets.facets, true, scene.triangles.size());
  else
    lights.use(std::move(regions), emitting_facets(scene), false, scene.triangles.size());
  view.lights.regions = lights.list().regions;
}

void KernelSceneData::use(EmissionGuide guide) {
  emission = std::move(guide);
  view.lights.emission = emission.table();
}

void KernelSceneData::use(ArrivalGuide guide) {
  arrivals = std::move(guide);
  view.lights.arrivals = arrivals.table();
}

}  // namespace castray
