#include <catch2/catch.hpp>

#include "generate/shapes.h"
#include "instanced.h"
#include "integrators.h"
#include "reference_images.h"
#include "same_bytes.h"
#include "test_scenes.h"

using namespace castray;
using namespace castray::test;

// A closed box that emits e and reflects k has radiance e / (1 - k), whatever the transport options.

namespace {

const Vec3d albedo{0.3, 0.5, 0.8};

struct Named {
  std::string name;
  RenderOptions options;
};

/// Each list of options once with each of the changes.
template <class Change>
std::vector<Named> combined(const std::vector<Named>& list,
                            const std::vector<std::pair<std::string, Change>>& changes) {
  std::vector<Named> all;
  for (const Named& named : list)
    for (const auto& [what, change] : changes) {
      all.push_back({named.name + ", " + what, named.options});
      change(all.back().options);
    }
  return all;
}

std::vector<Named> transport_options() {
  using Change = void (*)(RenderOptions&);
  using Changes = std::vector<std::pair<std::string, Change>>;
  RenderOptions options;
  options.width = options.height = 16;
  options.spp = 16;
  options.threads = 1;
  std::vector<Named> all{{"furnace", options}};
  all = combined(all, Changes{{"shared", [](RenderOptions&) {}},
                              {"plain", [](RenderOptions& o) { o.reuse = {.automatic = false}; }},
                              {"reference", [](RenderOptions& o) { o.integrator = Integrator::reference; }}});
  all = combined(all, Changes{{"roulette auto", [](RenderOptions&) {}},
                              {"roulette 0.7", [](RenderOptions& o) { o.rr = 0.7; }}});
  all = combined(all, Changes{{"MIS", [](RenderOptions& o) { o.mis = Switch::on; }},
                              {"no MIS", [](RenderOptions& o) { o.mis = Switch::off; }}});
  all = combined(
      all, Changes{{"lights auto", [](RenderOptions&) {}},
                   {"by area", [](RenderOptions& o) { o.lights = LightSampling::area; }},
                   {"by solid angle", [](RenderOptions& o) { o.lights = LightSampling::solid_angle; }}});
  std::erase_if(all, [](const Named& named) {  // the reference knows one way only
    const RenderOptions& o = named.options;
    return o.integrator == Integrator::reference && o.lights != LightSampling::automatic;
  });
  all = combined(all, Changes{{"list", [](RenderOptions&) {}},
                              {"tree", [](RenderOptions& o) { o.accel = AccelKind::bvh; }}});
  return combined(all, Changes{{"Sobol'", [](RenderOptions&) {}}, {"independent", [](RenderOptions& o) {
                                                                     o.sampler = SamplerKind::independent;
                                                                   }}});
}

/// That the mean of a furnace's image is what it must be, by 24 renders.
void check_furnace(const std::string& what, const Scene& scene, RenderOptions options) {
  const std::vector<double> expected{1 / (1 - albedo.x), 1 / (1 - albedo.y), 1 / (1 - albedo.z)};
  std::vector<std::vector<double>> renders;
  const PreparedScene prepared(scene, options);
  for (options.seed = 1; options.seed <= 24; ++options.seed)
    renders.push_back(block_means(render(prepared, options).film.image(), options.width));
  const BlockScores scores = block_scores(renders, expected, {0, 0, 0});
  CAPTURE(what, scores.largest);
  CHECK(scores.count == 3);
  CHECK(scores.largest < 4);
}

}  // namespace

// What is perfectly white does not change it, instances of whatever transform are no exception.
TEST_CASE("the furnace closes around white instances") {
  SceneSketch sketch;
  const auto wall = sketch.add_material({.name = "wall", .kd = albedo, .ke = Vec3d(1)}),
             white = sketch.add_material({.name = "white", .kd = Vec3d(1)});
  sketch.add_cube(1, {}, true, wall);
  const Shape shape = blob(4, 1);
  for (const double x : {-0.5, -0.2, 0.0, 0.2, 0.5})
    sketch.add_mesh(shape.positions, shape.triangles, 0.2, {x, x, -0.3 - x}, false, white);
  sketch.scene.camera = make_camera({0.1, 0.2, 0.9}, {0, 0, -0.3}, {0, 1, 0}, 60);
  const Scene scene = as_instances(sketch.scene, kinds_of_places());
  RenderOptions options = wavefront_options(16, 4, 1);
  check_same_bytes(scene, options);
  for (const Way& way : every_way(options, arithmetics())) {
    if (way.options.accel == AccelKind::list) continue;
    check_furnace(way.name, scene, way.options);
  }
}

// 112 combinations of 3 channels: one false alarm in 45 seeds.
TEST_CASE("the furnace closes with every transport option") {
  Scene scene = standard_scene("furnace");
  for (Material& material : scene.materials) material.kd = albedo;
  for (const Named& named : transport_options()) check_furnace(named.name, scene, named.options);
}
