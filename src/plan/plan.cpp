#include "plan/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "castray/error.h"
#include "core/contract.h"
#include "core/text.h"
#include "geometry/build_quality.h"
#include "lights/light_share.h"
#include "materials/descriptor.h"
#include "scene/needs.h"

namespace castray {

namespace {

/// With more, light points are what a tile's error comes from.
constexpr std::size_t few_light_triangles = 8;

/// Near the optimum, which is flat, in all scenes whose noise is at edges: not behind mirrors, glass and
/// polished metal, where pixels have paths of their own.
int edge_samples(const SceneNeeds& needs, const RenderOptions& options) {
  constexpr int usual = 3;
  return options.edge_samples.value_or(needs.specular ? 1 : usual);
}

bool use_list(const SceneNeeds& needs, const RenderOptions& options) {
  if (needs.instances > 0 || needs.textures || needs.smooth_normals || needs.coverage || needs.glass_shares)
    return false;  // facets have no barycentrics
  return options.accel == AccelKind::list ||
         (options.accel == AccelKind::automatic && needs.triangles <= longest_list);
}

/// Paths from lights know no vertices that have a smooth normal and a map that bends it: there is more than
/// one that they may be seen with. There is no kernel of them for instances.
bool may_have_light_paths(const SceneNeeds& needs) {
  return needs.specular && needs.lights > 0 && needs.instances == 0 &&
         !(needs.smooth_normals && needs.bent_normals);
}

/// The end of a shared suffix on a glossy surface keeps no direction to a light without size.
bool may_share(const SceneNeeds& needs) { return needs.delta_lights == 0 || !needs.glossy; }

/// spp is ignored: the tree changes low-order bits, and films that are merged or resumed must share one tree.
BuildQuality build_quality(const Scene& scene, const RenderOptions& options, const Window& window) {
  constexpr double usual_rays_of_a_pixel = 16 * 4;
  // A cut triangle is met more than once, and a window must take its colours once.
  const bool tints = std::ranges::any_of(scene.materials, &Material::tints);
  if (options.build == BuildQuality::fast || tints) return BuildQuality::fast;
  if (!scene.instances.empty())
    return options.build == BuildQuality::best ? BuildQuality::best : BuildQuality::fast;
  const double pixels = static_cast<double>(window.full_width) * window.full_height;
  const MeshView mesh = mesh_of(scene);
  return choose_build(options.build, wasted_boxes(mesh), mesh.count, usual_rays_of_a_pixel * pixels);
}

/// How many times as good something is: with two digits behind the point where it is hardly better or worse.
std::string times(double factor) {
  const bool near_tie = factor > 0.95 && factor < 1.05;
  return near_tie ? fmt::format("{:.2f} times", factor) : two_digits(factor) + " times";
}

std::string kernel_name(const Plan& plan) {
  std::string name = plan.list ? "list" : plan.features & feature_instances ? "BVH of instances" : "BVH";
  name += plan.features & feature_detail      ? ", all materials, textures, smooth normals"
          : plan.features & feature_materials ? ", all materials"
                                              : ", diffuse";
  name += plan.suffixes > 0 ? ", " + std::to_string(plan.suffixes) + " paths shared by 8x8 pixels"
                            : ", plain paths";
  if (plan.light_regions > 0)
    name += fmt::format(", lights by what is seen of them in {} {} (by a pilot, {} as good as by bounds)",
                        plan.light_regions, plan.light_regions == 1 ? "region" : "regions",
                        times(plan.gain_of_regions));
  if (plan.light_paths) name += ", caustics by paths from lights";
  if (plan.gain_of_light_paths > 0)
    name += fmt::format("{} (by a pilot, paths from lights are {} as efficient)",
                        plan.light_paths ? "" : ", caustics by chance", times(plan.gain_of_light_paths));
  return name + (plan.mis ? ", MIS" : "");
}

}  // namespace

Plan make_plan(const Scene& scene, const RenderOptions& options, const Window& window) {
  const SceneNeeds needs = needs_of(scene);
  Plan plan;
  plan.list = use_list(needs, options);
  const bool instances = needs.instances > 0;
  const bool detail = instances || needs.textures || needs.smooth_normals || (options.generic && !plan.list);
  const bool materials = detail || options.generic || needs.types != std::set{MaterialType::diffuse};
  plan.features = (plan.list ? 0u : feature_bvh) | (materials ? feature_materials : 0u) |
                  (detail ? feature_detail : 0u) | (instances ? feature_instances : 0u);
  plan.choose_lights_by_importance = options.lights != LightSampling::area;
  plan.lights_by_solid_angle = options.lights == LightSampling::solid_angle;
  plan.suffixes = !may_share(needs) ? 0 : options.reuse.automatic ? 64 : options.reuse.suffixes;
  if (options.reuse.automatic && needs.specular) plan.few_suffixes = plan.suffixes / 2;
  // One vertex later where plain paths are taken for their little noise: in the open, where most of them soon
  // leave the scene anyway. With mirrors and glass, behind which paths are long, that gains nothing.
  if (!needs.specular) plan.first_roulette = first_roulette_vertex + 1;
  plan.narrow_coats = needs.narrow_coats;
  plan.matte = !needs.specular && !needs.glossy && !needs.coverage && !needs.glass_shares;
  plan.light_points = needs.lights > few_light_triangles ? 16 : 8;
  plan.reconstruct = options.reconstruct != Switch::off;
  plan.edge_samples = edge_samples(needs, options);
  plan.environment_points = needs.environment && scene.environment_image.used() ? 16 : 0;
  plan.mis = uses_mis(options.mis, scene, std::max(1.0, double(plan.suffixes) / plan.light_points));
  plan.light_paths = may_have_light_paths(needs) && options.caustics != Switch::off;
  if (options.caustics == Switch::on && !plan.light_paths)
    throw InputError(
        "--caustics on: paths from lights need a lamp, a smooth mirror or glass, no instances, and not both "
        "smooth normals and normal or bump maps; leave it at auto");
  plan.build = plan.list ? BuildQuality::fast : build_quality(scene, options, window);
  plan.kernel = kernel_name(plan);
  const auto skip = [&plan](bool needed, std::string_view what) {
    if (!needed) plan.skipped.emplace_back(what);
  };
  skip(!plan.list, "tree");
  skip(plan.list || plan.build == BuildQuality::best, "cut boxes");
  skip(needs.instances > 0, "instances");
  skip(detail || needs.textures, "textures");
  skip(detail || needs.smooth_normals, "smooth normals");
  skip(needs.coverage, "coverage");
  for (const MaterialDescriptor* material : material_descriptors())
    if (material->type != MaterialType::diffuse) skip(materials, material->name);
  skip(needs.environment, "environment");
  skip(needs.delta_lights > 0, "lights without size");
  skip(needs.lights > 1, "choice among lights");
  skip(plan.light_paths, "paths from lights");
  skip(plan.mis, "multiple importance sampling");
  return plan;
}

bool keeps_differences(const RenderOptions& options, const Plan& plan) {
  return options.reconstruct != Switch::off && plan.reconstruct && plan.suffixes > 0 &&
         options.max_depth != 1;
}

std::string image_source(const Plan& plan, bool differences) {
  if (plan.suffixes == 0 || plan.gain_of_reconstruction == 0) return {};
  if (!differences && plan.reconstruct) return ", image from means";  // for reasons that no pilot knows
  std::string source =
      fmt::format(", image from {} (by a pilot, differences are {} as efficient at 4 samples)",
                  differences ? "differences of pixels" : "means", times(plan.gain_of_reconstruction));
  if (differences && plan.edge_samples > 1)
    source += fmt::format(", {} times the samples at edges", plan.edge_samples);
  return source;
}

void choose_lights_by_regions(Plan& plan, std::size_t regions, double gain) {
  plan.light_regions = regions;
  plan.gain_of_regions = gain;
  plan.kernel = kernel_name(plan);
}

void choose_caustics(Plan& plan, double gain_of_light_paths) {
  plan.light_paths = gain_of_light_paths >= 1;
  plan.gain_of_light_paths = gain_of_light_paths;
  plan.kernel = kernel_name(plan);
}

void choose_number_of_light_paths(Plan& plan, double gain_of_twice) {
  constexpr double much = 1.25;  // bright samples that no pilot met are an error that light paths leave
  if (!plan.light_paths || !(gain_of_twice > much)) return;
  plan.twice_the_light_paths = true;
  plan.light_paths_per_pixel *= 2;
  plan.kernel +=
      fmt::format(", twice as many paths from lights (by a pilot, {} as efficient)", times(gain_of_twice));
}

void choose_two_branches(Plan& plan, double gain, double error) {
  constexpr double enough = 1.1;
  if (plan.suffixes > 0 || gain == 1) return;  // 1: none was tried
  // the pilot's error hides a gain as often as it feigns one: half of it counts
  const bool taken = gain > std::max(enough, std::sqrt(error));
  if (taken) plan.branches = 2;
  plan.kernel += fmt::format(
      ", {} from what each camera ray meets (by a pilot, two are {} as efficient, give or take a factor of "
      "{})",
      taken ? "two of them" : "one", times(gain), two_digits(error));
}

void choose_reconstruction(Plan& plan, std::optional<double> gain) {
  plan.gain_of_reconstruction = gain.value_or(0);
  plan.reconstruct = plan.gain_of_reconstruction > 1;
  plan.kernel = kernel_name(plan);
}

void choose_by_pilot(Plan& plan, double gain_of_sharing, double error, bool few, bool by_single_samples) {
  constexpr double enough = 1.5;
  // A wrong choice of few suffixes costs little, and plain paths have bright samples that are rarer than
  // pilots meet. But where caustics by chance are very bright, one that a suffix meets behind glass shows as
  // a bright square.
  constexpr double very_bright = 200;
  const double in_doubt = std::min(error, enough);
  const double least = !few || by_single_samples                 ? in_doubt
                       : plan.gain_of_light_paths >= very_bright ? enough
                                                                 : 1 / in_doubt;
  if (gain_of_sharing < least)
    plan.suffixes = 0;
  else if (few)
    plan.suffixes = plan.few_suffixes;
  plan.kernel =
      fmt::format("{} (by a pilot, sharing{} is {} as efficient as plain paths, give or take a factor of {})",
                  kernel_name(plan), few ? fmt::format(" {}", plan.few_suffixes) : "", times(gain_of_sharing),
                  two_digits(error));
}

}  // namespace castray
