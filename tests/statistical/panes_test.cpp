#include <catch2/catch.hpp>

#include <cmath>

#include "castray_blocks.h"
#include "instanced.h"

using namespace castray;
using namespace castray::test;

// Thin panes, through which lamps and skies are seen as if nothing were there: the kernels against castRay in
// double precision, and castRay against panes whose light it finds by chance alone. Each `check` has a
// false-alarm rate of 1e-4.

namespace {

const Vec3d tint{0.9, 0.5, 0.2};

Material pane(const Vec3d& transmittance = Vec3d(1)) {
  Material m{.name = "pane", .type = MaterialType::dielectric, .transmittance = transmittance};
  m.thin = true;
  return m;
}

/// It shines, but by nothing: so it is no window, and shadow rays end at it.
Material blind(Material m) {
  m.ke = Vec3d(1e-30);
  return m;
}

/// A floor and a wall under a lamp, `panes` below it, tilted, and a sky.
Scene room(const Material& glass, int panes, float lamp_side = 0.3f) {
  SceneSketch sketch;
  const auto floor = sketch.add_material({.name = "floor", .kd = {0.7, 0.6, 0.5}});
  const auto lamp =
      sketch.add_material({.name = "lamp", .kd = {}, .ke = Vec3d(0.8) / std::pow(lamp_side, 2)});
  const auto of_panes = sketch.add_material(glass);
  const float s = lamp_side;
  sketch.add_quad({-1, -0.5f, 1}, {1, -0.5f, 1}, {1, -0.5f, -1}, {-1, -0.5f, -1}, floor);
  sketch.add_quad({-1, -0.5f, -1}, {1, -0.5f, -1}, {1, 1, -1}, {-1, 1, -1}, floor);
  sketch.add_quad({-s, 1, s}, {-s, 1, -s}, {s, 1, -s}, {s, 1, s}, lamp);
  for (int i = 0; i < panes; ++i) {
    const float y = 0.5f - 0.3f * static_cast<float>(i), up = 0.2f * static_cast<float>(i + 1);
    sketch.add_quad({-.9f, y, .9f}, {.9f, y + up, .9f}, {.9f, y + up, -.9f}, {-.9f, y, -.9f}, of_panes);
  }
  sketch.scene.environment = {0.1, 0.15, 0.2};
  sketch.scene.camera = make_camera({0.6, 1, 2.6}, {0, 0, 0}, {0, 1, 0}, 40);
  return sketch.scene;
}

/// A box of panes before a white sky.
Scene box() {
  SceneSketch sketch;
  sketch.add_cube(0.5, {}, false, sketch.add_material(pane()));
  sketch.scene.environment = Vec3d(1);
  sketch.scene.camera = make_camera({0.6, 1, 2.6}, {0, 0, 0}, {0, 1, 0}, 30);
  return sketch.scene;
}

}  // namespace

TEST_CASE("kernels see lamps and skies through panes as castRay does", "[statistical]") {
  const Scene scene = room(pane(tint), 2);
  const Expected expected(scene, wavefront_options(8));
  expected.check("plain", scene, plain(wavefront_options(4)));
  expected.check_with("shared, MIS", scene, [](RenderOptions& o) { o.mis = Switch::on; });
  expected.check_with("boxes cut", scene, [](RenderOptions& o) { o.build = BuildQuality::best; });
  expected.check("instances", as_instances(scene, kinds_of_places()), wavefront_options(4));
}

TEST_CASE("the light of panes is that which paths find by chance", "[statistical]") {
  for (const Vec3d& transmittance : {Vec3d(1), tint}) {
    const Material glass = pane(transmittance);
    const Expected expected(room(glass, 2), wavefront_options(8));
    expected.check("by chance", room(blind(glass), 2), plain(wavefront_options(32)));
  }
}

// At 5 sigma a false alarm once in a million seeds.
TEST_CASE("a box of white panes takes no light away", "[statistical]") {
  for (const bool shared : {true, false}) {
    RenderOptions options = wavefront_options(16);
    options.reuse.automatic = shared;
    Mean mean;
    for (const Vec3f& p : render(box(), options).film.image().pixels) mean.add(static_cast<double>(p.x));
    CAPTURE(mean.mean(), mean.error());
    CHECK(std::abs(mean.mean() - 1) < 5 * mean.error() + 1e-6);
    CHECK(mean.error() < 1e-3);
  }
}

TEST_CASE("a small lamp behind a pane is not found by chance") {
  const auto noise = [](const Material& glass) {
    const Blocks blocks = blocks_of(room(glass, 1, 0.05f), plain(wavefront_options(8)), 6);
    double variance = 0;
    for (std::size_t b = 0; b < blocks[0].size(); ++b) {
      Mean mean;
      for (const auto& render : blocks) mean.add(render[b]);
      variance += mean.variance();
    }
    return variance;
  };
  const double window = noise(pane()), by_chance = noise(blind(pane()));
  CAPTURE(window, by_chance);
  CHECK(window < by_chance / 50);
}
