#include <catch2/catch.hpp>

#include "castray_blocks.h"
#include "integrators.h"

using namespace castray;
using namespace castray::test;

// Lights chosen by what a pilot saw of them, against castRay in double precision, which chooses by power.

namespace {

/// A room parted by a thin wall with a door. The lamp beyond it is 30 times as bright as the one on this
/// side, and three small ones stand there out of sight. `block`: the material of a block on this side.
Scene parted_room(const Material& block) {
  SceneSketch sketch;
  const auto white = sketch.add_material({.name = "white", .kd = Vec3d(0.7)});
  const auto dim = sketch.add_material({.name = "dim", .kd = Vec3d(0.3), .ke = Vec3d(1)});
  const auto bright = sketch.add_material({.name = "bright", .kd = Vec3d(0.3), .ke = Vec3d(30, 25, 20)});
  sketch.add_cube(0.9, {}, true, white);
  sketch.add_quad({0.1f, -0.9f, -0.9f}, {0.1f, 0.9f, -0.9f}, {0.1f, 0.9f, 0.4f}, {0.1f, -0.9f, 0.4f}, white);
  const auto lamp = [&](float x, float y, float z, float size, std::uint16_t material) {
    sketch.add_quad({x - size, y, z - size}, {x + size, y, z - size}, {x + size, y, z + size},
                    {x - size, y, z + size}, material);
  };
  lamp(-0.4f, 0.85f, -0.2f, 0.15f, dim);
  lamp(0.5f, 0.85f, -0.4f, 0.15f, bright);
  for (const float z : {-0.8f, -0.5f, -0.2f}) lamp(0.7f, 0.2f, z, 0.05f, bright);
  sketch.add_cube(0.2, {-0.5, -0.69, -0.4}, false, sketch.add_material(block));
  sketch.scene.camera = make_camera({-0.4, 0.1, 0.85}, {-0.35, -0.1, -0.5}, {0, 1, 0}, 60);
  return sketch.scene;
}

void check_parted_room(const std::string& name, const Material& block) {
  const Scene scene = parted_room(block);
  RenderOptions reference = wavefront_options(64);
  reference.mis = Switch::on;
  const Expected expected(scene, reference, 48);
  check_same_bytes(scene, wavefront_options(2));
  for (const std::string& isa : arithmetics())
    for (const AccelKind accel : {AccelKind::list, AccelKind::bvh}) {
      RenderOptions options = wavefront_options(8);
      options.isa = isa;
      options.accel = accel;
      const std::string what = name + ", " + isa + (accel == AccelKind::list ? ", list" : ", tree");
      CHECK_THAT(render(scene, options).film.key, Catch::EndsWith("; light-choice=learned"));
      expected.check(what + ", shared", scene, options);
      expected.check(what + ", plain", scene, plain(options));
    }
}

}  // namespace

TEST_CASE("lights chosen by what is seen of them have castRay's mean", "[statistical]") {
  check_parted_room("diffuse", {.name = "block", .kd = {.7, .4, .2}});
}

TEST_CASE("lights chosen by what is seen of them have castRay's mean with metal", "[statistical]") {
  check_parted_room("metal", {.name = "block", .type = MaterialType::conductor, .alpha = 0.3});
}

TEST_CASE("lights chosen by what is seen of them have castRay's mean with glass", "[statistical]") {
  check_parted_room("glass", {.name = "block", .type = MaterialType::dielectric, .alpha = 0.4});
}

TEST_CASE("what is seen of lights does not depend on the part rendered, nor on threads") {
  const Scene scene = parted_room({.name = "block", .kd = {.7, .4, .2}});
  RenderOptions options = wavefront_options(2);
  options.width = options.height = 64;
  const RenderResult whole = render(scene, options);
  CHECK(whole.stats.pilot_seconds > 0);
  CHECK_THAT(whole.stats.kernel, Catch::Contains("lights by what is seen of them"));
  options.threads = 3;
  CHECK(render(scene, options).film.image().pixels == whole.film.image().pixels);
  const Window crop{.x0 = 20, .y0 = 30, .x1 = 33, .y1 = 41};
  options.crop = crop;
  const RenderResult part = render(scene, options);
  CHECK(part.film.key == whole.film.key);
  const Image all = whole.film.image(), some = part.film.image();
  for (int y = crop.y0; y < crop.y1; ++y)
    for (int x = crop.x0; x < crop.x1; ++x) REQUIRE(some.at(x - crop.x0, y - crop.y0) == all.at(x, y));
}

TEST_CASE("one light, and lights chosen as asked for, need no pilot of lights") {
  const Scene box = standard_scene("cornell_box"),
              parted = parted_room({.name = "block", .kd = {.7, .4, .2}});
  RenderOptions options = plain(wavefront_options(1));
  CHECK(render(box, options).film.key.find("light-choice=learned") == std::string::npos);
  for (const LightSampling lights : {LightSampling::area, LightSampling::tree, LightSampling::solid_angle}) {
    options.lights = lights;
    CHECK(render(parted, options).film.key.find("light-choice=learned") == std::string::npos);
  }
}
