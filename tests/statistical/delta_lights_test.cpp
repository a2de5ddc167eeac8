#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>
#include <string>

#include "castray_blocks.h"
#include "integrators.h"
#include "test_scenes.h"

using namespace castray;
using namespace castray::test;

// Lights without size: against values that are known exactly, and the wavefront against castRay.

namespace {

using Kind = DeltaLight::Kind;

const DeltaLight point{.kind = Kind::point, .position = {0.2, 0.3, -0.1}, .intensity = {0.4, 0.5, 0.6}};
const DeltaLight spot{.kind = Kind::spot,
                      .position = {-0.3, 0.4, -0.4},
                      .direction = {0.6, -0.8, 0},
                      .intensity = {2, 1, 0.5},
                      .cos_outer = 0.8,
                      .cos_inner = 0.95};
const DeltaLight far{
    .kind = Kind::directional, .position = {}, .direction = {0.36, -0.48, 0.8}, .intensity = {1, 1, 2}};

Scene lit(Scene scene, std::vector<DeltaLight> lights) {
  scene.delta_lights = std::move(lights);
  return scene;
}

/// A diffuse plane at y = 0, seen from above in a narrow view of its middle.
Scene plane(double albedo) {
  SceneSketch sketch;
  const auto ground = sketch.add_material({.name = "ground", .kd = Vec3d(albedo)});
  sketch.add_quad({-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, {-1, 0, -1}, ground);
  sketch.scene.camera = make_camera({0, 0.9, 0}, {0, 0, 0}, {0, 0, -1}, 0.001);
  return sketch.scene;
}

}  // namespace

TEST_CASE("a plane reflects what lights without size send it, without noise") {
  const double pi = std::numbers::pi;
  struct Case {
    std::string name;
    DeltaLight light;
    double irradiance;
  };
  const double share = (0.8 - 0.7) / (0.9 - 0.7);  // of a spot whose axis is at cosine 0.8
  const std::vector<Case> cases = {
      {"point", {.kind = Kind::point, .position = {0.3, 0.4, 0}, .intensity = Vec3d(2)}, 2 / 0.25 * 0.8},
      {"far away", {.kind = Kind::point, .position = {30, 40, 0}, .intensity = Vec3d(2e4)}, 2e4 / 2500 * 0.8},
      {"directional",
       {.kind = Kind::directional, .position = {}, .direction = {0.6, -0.8, 0}, .intensity = Vec3d(3)},
       2.4},
      {"spot",
       {.kind = Kind::spot,
        .position = {0.3, 0.4, 0},
        .direction = {0, -1, 0},
        .intensity = Vec3d(2),
        .cos_outer = 0.7,
        .cos_inner = 0.9},
       share * share * 2 / 0.25 * 0.8},
      {"beside a spot",
       {.kind = Kind::spot,
        .position = {0.3, 0.4, 0},
        .direction = {0, -1, 0},
        .intensity = Vec3d(2),
        .cos_outer = 0.81},
       0},
      {"behind", {.kind = Kind::point, .position = {0.3, -0.4, 0}, .intensity = Vec3d(2)}, 0}};
  for (const Case& c : cases)
    for (const Way& way : every_way(wavefront_options(8, 2, 1))) {
      CAPTURE(c.name, way.name);
      for (const Vec3f& pixel : render(lit(plane(0.5), {c.light}), way.options).film.image().pixels)
        REQUIRE(pixel.x == Approx(0.5 / pi * c.irradiance).epsilon(1e-3));
    }
}

TEST_CASE("lights without size: the wavefront agrees with castRay", "[statistical]") {
  Scene box = standard_scene("cornell_box");
  check_scene("with a lamp", lit(box, {point, spot, far}));
  for (Material& m : box.materials) m.ke = {};
  box.lights.clear();
  for (const DeltaLight& light : {point, spot, far})
    check_scene("alone " + std::to_string(static_cast<int>(light.kind)), lit(box, {light}));
  Scene outdoors = standard_scene("kinds/sky_and_ground");
  check_scene("under a sky", lit(outdoors, {point, far}));
}

TEST_CASE("lights without size: the wavefront agrees with castRay on every material", "[statistical]") {
  const auto with = [](const Material& material) {
    Scene scene = standard_scene("cornell_conductor");
    for (Material& m : scene.materials)
      if (m.type == MaterialType::conductor) m = material;
    return lit(scene, {point, spot, far});
  };
  check_scene("rough metal", with({.name = "m", .type = MaterialType::conductor, .alpha = 0.3}));
  check_scene("rough glass", with({.name = "g", .type = MaterialType::dielectric, .alpha = 0.4}));
  Scene mirror = with({.name = "m", .type = MaterialType::conductor, .alpha = 0});
  check_scene("mirror", mirror);
  check_scene("half there", with({.name = "h", .coverage = 0.5}));
}

TEST_CASE("lights without size: every form of the wavefront has the same mean", "[statistical]") {
  const Scene scene = lit(standard_scene("cornell_box"), {point, spot, far});
  const Expected expected(scene);
  expected.check_each_kernel(scene);
  expected.check_with("generic", scene, [](RenderOptions& o) { o.generic = true; });
  expected.check_with("MIS", scene, [](RenderOptions& o) { o.mis = Switch::on; });
}

TEST_CASE("lights without size are direct light: it is not clamped") {
  for (const bool shared : {true, false}) {
    RenderOptions options = wavefront_options(8, 2, 1);
    options.reuse.automatic = shared;
    const Scene scene =
        lit(plane(0.5), {{.kind = Kind::point, .position = {0, 0.5, 0}, .intensity = Vec3d(2)}});
    const Image free = render(scene, options).film.image();
    options.clamp_indirect = 0.01;
    CHECK(render(scene, options).film.image().pixels == free.pixels);
  }
}
