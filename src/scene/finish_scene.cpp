// What a scene is after all has been added: meshes and instances in scene space, checked, with sky and
// cameras.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <utility>

#include "castray/error.h"
#include "core/box.h"
#include "core/range.h"
#include "core/text.h"
#include "materials/brightest_emission.h"
#include "materials/surface_values.h"
#include "scene/scene_builder.h"

namespace castray {

namespace {

template <class T, class Predicate>
std::vector<bool> marked(const std::vector<T>& values, const Predicate& is_marked) {
  std::vector<bool> marks(values.size());
  std::transform(values.begin(), values.end(), marks.begin(), is_marked);
  return marks;
}

Box3d box_of(const std::vector<Vec3d>& points) {
  Box3d box;
  for (const Vec3d& p : points) box.add(p);
  return box;
}

/// The space of coordinates (p - center) / unit.
struct Space {
  Vec3d center;
  double unit = 1;
};

bool has_area(const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  // Differences of floats in [-1,1] and their products are nearly exact in double: 0 means collinear.
  return cross(Vec3d(b) - Vec3d(a), Vec3d(c) - Vec3d(a)) != Vec3d{};
}

/// Every point of the box is of [-1,1]^3 in it.
Space space_around(const Box3d& box) {
  Space space;
  const Vec3d half = box.upper * 0.5 - box.lower * 0.5;
  space.center = box.lower * 0.5 + box.upper * 0.5;
  int exponent;
  const double fraction = std::frexp(max_component(half), &exponent);
  space.unit = std::ldexp(1.0, fraction == 0.5 ? exponent - 1 : exponent);
  if (!(space.unit > 0)) space.unit = 1;  // no extent: every triangle will be dropped
  return space;
}

}  // namespace

void SceneBuilder::expand(const Mesh& object, const Transform& transform) {
  Mesh copy = object;
  apply(transform, copy);
  drop_degenerate(copy, scene.file);
  add_to_scene(std::move(copy));
}

/// Copies objects once for each other material in which they are placed.
void SceneBuilder::make_objects_of_materials() {
  std::map<std::pair<std::size_t, std::uint16_t>, std::size_t> copies;
  for (Placed& instance : instances_) {
    if (!instance.material) continue;
    const auto [copy, is_new] = copies.try_emplace({instance.object, *instance.material}, objects_.size());
    if (is_new) {
      Mesh mesh = objects_[instance.object];
      mesh.triangle_material.assign(mesh.triangles.size(), *instance.material);
      objects_.push_back(std::move(mesh));
    }
    instance.object = copy->second;
  }
}

/// Makes meshes of their own of all that is better not an instance: of every one where there are few
/// triangles, and else of lights, which are sampled, and of what its transform skews so much that rounding a
/// ray to its space would move it too far.
void SceneBuilder::expand_instances() {
  constexpr std::size_t few_triangles = std::size_t{1} << 20;
  std::size_t shown = 0;
  for (const Placed& instance : instances_) shown += objects_[instance.object].triangles.size();
  const bool all =
      instancing == Instancing::expand || (instancing == Instancing::automatic && shown <= few_triangles);

  const auto emits = [&](std::uint16_t material) { return scene.emits(material); };
  std::vector<Mesh> lights(objects_.size());
  for (std::size_t i = 0; i < objects_.size() && !all; ++i) {
    if (std::ranges::none_of(objects_[i].triangle_material, emits)) continue;
    lights[i] = objects_[i];
    keep_triangles(lights[i], marked(objects_[i].triangle_material, emits));
    drop_unused(lights[i].positions, lights[i].triangles);
    keep_triangles(objects_[i], marked(objects_[i].triangle_material, std::not_fn(emits)));
  }
  std::vector<Placed> kept;
  for (const Placed& instance : instances_) {
    const bool whole = all || instance.transform.skew() > most_skew;
    scene.expanded_instances += whole;
    if (whole) expand(objects_[instance.object], instance.transform);
    if (!lights[instance.object].triangles.empty()) expand(lights[instance.object], instance.transform);
    if (!whole && !objects_[instance.object].triangles.empty()) kept.push_back(instance);
  }
  instances_ = std::move(kept);
}

void SceneBuilder::require_triangles() const {
  if (!mesh_.triangles.empty() || !instances_.empty()) return;
  if (scene.dropped_triangles == 0 && without_faces_)
    throw InputError(SourcePlace{without_faces_->string()}, "no faces, so that the scene has no triangle");
  const std::string dropped = scene.dropped_triangles == 0
                                  ? ""
                                  : " left: all " + std::to_string(scene.dropped_triangles) +
                                        " are degenerate (no area, or coordinates that are not finite)";
  throw InputError(SourcePlace{scene.file.string()}, "the scene has no triangle" + dropped);
}

void SceneBuilder::find_scene_space() {
  Box3d all = box_of(mesh_.positions);
  std::vector<Box3d> boxes;
  for (const Mesh& object : objects_) boxes.push_back(box_of(object.positions));
  for (const Placed& instance : instances_)
    for (const Vec3d& corner : boxes[instance.object].corners()) {
      all.add(instance.transform.point(corner));
      if (!is_in_reach(instance.transform.point(corner)))
        throw InputError(SourcePlace{scene.file.string()},
                         fmt::format("an instance reaches farther than {:g} from the origin; bring it nearer",
                                     farthest_coordinate));
    }
  const Space space = space_around(all);
  scene.center = space.center;
  scene.unit = space.unit;
}

/// Moves meshes to scene space and objects to theirs, and joins all.
void SceneBuilder::move_to_scene_space() {
  for (Vec3d& p : mesh_.positions) p = scene.to_scene(p);
  std::vector<Space> spaces;
  for (Mesh& object : objects_) {
    const auto first = static_cast<std::uint32_t>(mesh_.triangles.size());
    const Space& space = spaces.emplace_back(space_around(box_of(object.positions)));
    for (Vec3d& p : object.positions) p = (p - space.center) / space.unit;
    scene.shared_meshes.push_back({first, static_cast<std::uint32_t>(object.triangles.size())});
    add_to_scene(std::exchange(object, {}));
  }
  for (const Placed& instance : instances_) {
    const Space& space = spaces[instance.object];
    SceneInstance placed{static_cast<std::uint32_t>(instance.object), {}, {}};
    for (int i = 0; i < 3; ++i)
      placed.rows[i] = Vec3f(instance.transform.rows[i] * (space.unit / scene.unit));
    placed.translation = Vec3f(scene.to_scene(instance.transform.point(space.center)));
    scene.instances.push_back(placed);
  }
}

void SceneBuilder::round_positions() {
  scene.positions.resize(mesh_.positions.size());
  for (std::size_t i = 0; i < mesh_.positions.size(); ++i) scene.positions[i] = Vec3f(mesh_.positions[i]);
}

void SceneBuilder::warn_of_rounding() {
  constexpr double tolerated = 1e-3;                // of a triangle's longest edge
  constexpr double rounding = 0x1p-25 * 1.7320508;  // the most that a corner in [-1,1]^3 is moved by
  std::size_t moved = 0;
  double most = 0;
  for (const Index3& corners : mesh_.triangles) {
    double longest = 0, error = 0;
    for (std::size_t i = 0; i < 3; ++i)
      longest = std::max(
          longest, length(Vec3d(scene.positions[corners[i]]) - Vec3d(scene.positions[corners[(i + 1) % 3]])));
    if (longest > rounding / tolerated) continue;
    for (std::uint32_t i : corners)
      error = std::max(error, length(Vec3d(scene.positions[i]) - mesh_.positions[i]));
    const double share = longest > 0 ? error / longest : 1;
    most = std::max(most, share);
    moved += share > tolerated;
  }
  if (moved == 0) return;
  warnings.add({scene.file.string()},
               fmt::format("{} of {} triangles are so small beside the whole scene that rounding moves their "
                           "corners, by {} their longest edge; bring far parts nearer or leave them out",
                           moved, mesh_.triangles.size(),
                           most < 1 ? fmt::format("up to {} % of", two_digits(100 * most)) : "more than"));
}

void SceneBuilder::warn_of_missing_uvs() {
  if (std::ranges::none_of(scene.materials, &Material::has_maps)) return;
  std::vector<std::size_t> missing(scene.materials.size());
  for (std::size_t t = 0; t < scene.triangles.size(); ++t)
    if (scene.triangle_uvs.empty() || scene.triangle_uvs[t][0] == Scene::no_index)
      ++missing[scene.triangle_material[t]];
  for (std::size_t m = 0; m < missing.size(); ++m)
    if (scene.materials[m].has_back())
      missing[static_cast<std::size_t>(scene.materials[m].back)] += missing[m];
  for (std::size_t m = 0; m < missing.size(); ++m)
    if (missing[m] > 0 && scene.materials[m].has_maps())
      warnings.add(
          {scene.file.string()},
          fmt::format("material '{}' has images, but triangles without texture coordinates: they get "
                      "the constants alone",
                      printable(scene.materials[m].name)),
          Harm::changes_picture, missing[m]);
}

void SceneBuilder::drop_flat() {
  std::vector<bool> keep(mesh_.triangles.size());
  for (std::size_t t = 0; t < keep.size(); ++t) {
    const Index3& corners = mesh_.triangles[t];
    keep[t] = has_area(scene.positions[corners[0]], scene.positions[corners[1]], scene.positions[corners[2]]);
  }
  const auto kept = [&](std::uint32_t first, std::uint32_t count) {
    return static_cast<std::uint32_t>(std::count(keep.begin() + first, keep.begin() + first + count, true));
  };
  std::uint32_t first = scene.shared_meshes.empty() ? 0 : kept(0, scene.shared_meshes.front().first);
  for (SharedMesh& mesh : scene.shared_meshes) {
    mesh = {first, kept(mesh.first, mesh.count)};
    first += mesh.count;
  }
  std::erase_if(scene.instances,
                [&](const SceneInstance& at) { return scene.shared_meshes[at.mesh].count == 0; });
  warn_of_dropped(TriangleFault::no_area, {scene.file.string()},
                  static_cast<std::uint64_t>(std::ranges::count(keep, false)));
  keep_triangles(mesh_, keep);
}

namespace {

/// Radiance of the sky of a scene without lights.
constexpr double default_sky = 1;

/// Factors of images are in range, and so are their values: products of both may not be.
void check_brightness(const Scene& scene) {
  const double brightest = brightest_emission(scene);
  if (!(brightest <= radiance_range.greatest))
    throw InputError(SourcePlace{scene.file.string()},
                     fmt::format("images make radiance as great as {:.3g}; it must be {}", brightest,
                                 radiance_range.text()));
}

}  // namespace

/// What arrives from a light that is as far away as the scene is large is a float in kernels.
void SceneBuilder::move_lights_to_scene_space() {
  for (std::size_t i = 0; i < scene.delta_lights.size(); ++i) {
    DeltaLight& light = scene.delta_lights[i];
    light = scene.to_scene(light);
    for (int c = 0; c < 3; ++c)
      if (!radiance_range.contains(light.intensity[c]))
        throw InputError(
            SourcePlace{scene.file.string()},
            fmt::format(
                "lights[{}]: intensity / d^2 is {:g} where d, {:g}, is the size of the scene; it must be {}",
                i, light.intensity[c], scene.unit, radiance_range.text()));
  }
}

/// A screen or a dial that glows, no brighter than white paper under the sky, is not what lights an asset.
bool SceneBuilder::needs_sky() const {
  if (environment_given || !scene.delta_lights.empty()) return false;
  return scene.lights.empty() || (is_asset && brightest_emission(scene) <= default_sky);
}

/// The first camera is the scene's.
void SceneBuilder::place_cameras() {
  for (SceneCamera& camera : scene.cameras) camera.camera = scene.to_scene(camera.camera);
  scene.has_camera = !scene.cameras.empty();
  if (scene.has_camera && scene.cameras.front().width > 0) {
    scene.width = scene.cameras.front().width;
    scene.height = scene.cameras.front().height;
  }
  scene.camera = scene.has_camera ? scene.cameras.front().camera : automatic_camera(scene);
}

void SceneBuilder::add_glass_shares() {
  using Parameter = SurfaceParameter;
  for (std::size_t i = 0, count = scene.materials.size(); i < count; ++i) {
    Material glass = scene.materials[i];
    if (glass.type != MaterialType::principled || !(glass.transmission > 0)) continue;
    glass.name += " (glass)";
    glass.type = MaterialType::dielectric;
    glass.transmittance = glass.kd;
    glass.map(Parameter::transmittance) = glass.map(Parameter::kd);
    for (const Parameter p : {Parameter::kd, Parameter::ks, Parameter::metallic, Parameter::sheen,
                              Parameter::clearcoat, Parameter::clearcoat_roughness})
      glass.map(p) = {};
    glass.vertex_colors = false;
    glass.eta = glass.k = {};
    glass.is_glass_share = true;
    scene.materials[i].glass = add_material(std::move(glass));
  }
}

Scene SceneBuilder::finish() {
  add_glass_shares();
  make_objects_of_materials();
  expand_instances();
  if (instances_.empty()) objects_.clear();
  std::erase_if(instances_, [&](const Placed& i) { return objects_[i.object].triangles.empty(); });
  require_triangles();
  find_scene_space();
  move_to_scene_space();
  round_positions();
  warn_of_rounding();
  mesh_.positions = {};
  drop_flat();
  require_triangles();
  drop_unused(scene.positions, mesh_.triangles);
  scene.triangles = std::move(mesh_.triangles);
  scene.triangle_material = std::move(mesh_.triangle_material);
  scene.objects = std::move(mesh_.objects);
  scene.normals = std::move(mesh_.normals);
  scene.triangle_normals = std::move(mesh_.triangle_normals);
  scene.uvs = std::move(mesh_.uvs);
  scene.triangle_uvs = std::move(mesh_.triangle_uvs);
  scene.colors = std::move(mesh_.colors);
  scene.triangle_colors = std::move(mesh_.triangle_colors);
  warn_of_missing_uvs();
  scene.warnings = warnings.take();
  for (Material& m : scene.materials)  // an image that is black everywhere is no light
    if (mean_emission(scene, m) == Vec3d()) m.ke = {};
  check_brightness(scene);
  for (std::uint32_t t = 0; t < scene.own_triangles(); ++t)
    if (scene.emits(scene.triangle_material[t])) scene.lights.push_back(t);
  move_lights_to_scene_space();
  scene.default_environment = needs_sky();
  if (scene.default_environment) scene.environment = Vec3d(default_sky);
  place_cameras();
  return std::move(scene);
}

}  // namespace castray
