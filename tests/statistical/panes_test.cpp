#include <catch2/catch.hpp>

#include <cmath>

#include "castray_blocks.h"
#include "instanced.h"
#include "materials/texture.h"

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

/// The same with an image of the panes' colours, from black to white.
Scene room_of_images(Material glass) {
  Image colors(2, 2);
  colors.pixels = {{0, 0, 0}, {1, 0.1f, 0.6f}, {0.2f, 0.9f, 0.2f}, {1, 1, 1}};
  glass.map(SurfaceParameter::transmittance).texture = 0;
  Scene scene = room(glass, 2);
  scene.textures.push_back(make_texture("colours", colors));
  scene.uvs = {{0, 0}, {1.3f, 0}, {0.2f, 1.4f}};
  scene.triangle_uvs.assign(scene.triangles.size(), {0, 1, 2});
  return scene;
}

/// A floor in the sun, seen from below a pane that lies over it.
Scene floor_in_the_sun(const Material& glass) {
  SceneSketch sketch;
  const auto floor = sketch.add_material({.name = "floor", .kd = Vec3d(0.5)});
  const auto of_pane = sketch.add_material(glass);
  sketch.add_quad({-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, {-1, 0, -1}, floor);
  sketch.add_quad({-1, 0.9f, 1}, {1, 0.9f, 1}, {1, 0.9f, -1}, {-1, 0.9f, -1}, of_pane);
  sketch.scene.delta_lights.push_back({.kind = DeltaLight::Kind::directional,
                                       .position = {},
                                       .direction = {0.6, -0.8, 0},
                                       .intensity = Vec3d(1)});
  sketch.scene.camera = make_camera({0, 0.8, 0.5}, {0, 0, 0}, {0, 1, 0}, 40);
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
  expected.check_with("shared, MIS, with boxes that would be cut", scene, [](RenderOptions& o) {
    o.mis = Switch::on;
    o.build = BuildQuality::best;
  });
  expected.check_with("paths from lights", scene, [](RenderOptions& o) { o.caustics = Switch::on; });
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

TEST_CASE("an image of a pane's colours dims light as paths find by chance", "[statistical]") {
  const Scene scene = room_of_images(pane());
  const Expected expected(scene, wavefront_options(8), 12);
  expected.check("shared", scene, wavefront_options(4), 12);
  expected.check("by chance", room_of_images(blind(pane())), plain(wavefront_options(16)), 12);
}

// No path finds the sun by chance; each of its colours passes as much as that of the pane says.
TEST_CASE("the sun has the colour of the pane that it shines through") {
  const auto lit = [](const Material& glass, const std::string& isa) {
    RenderOptions options = plain(wavefront_options(1));
    options.max_depth = 2;
    options.isa = isa;
    return Vec3d(render(floor_in_the_sun(glass), options).film.image().at(16, 16));
  };
  for (const std::string& isa : instruction_sets()) {
    const Vec3d clear = lit(pane(), isa), tinted = lit(pane(tint), isa);
    CAPTURE(isa, clear.x, tinted.x);
    CHECK(clear.x > 0.1);
    for (int c = 0; c < 3; ++c) CHECK(tinted[c] == Approx(clear[c] * tint[c]).epsilon(1e-4));
  }
}

TEST_CASE("a small lamp behind a pane is not found by chance") {
  // as 8 samples have it; what is found by chance is rare, and needs more to be told
  const auto noise = [](const Material& glass, std::uint64_t spp) {
    const Blocks blocks = blocks_of(room(glass, 1, 0.05f), plain(wavefront_options(spp)), 6);
    double variance = 0;
    for (std::size_t b = 0; b < blocks[0].size(); ++b) {
      Mean mean;
      for (const auto& render : blocks) mean.add(render[b]);
      variance += mean.variance();
    }
    return variance * static_cast<double>(spp) / 8;
  };
  for (const Vec3d& transmittance : {Vec3d(1), tint}) {
    const double window = noise(pane(transmittance), 8), by_chance = noise(blind(pane(transmittance)), 128);
    CAPTURE(transmittance.y, window, by_chance);
    CHECK(window < by_chance / 50);
  }
}
