#include <catch2/catch.hpp>

#include <cmath>

#include "castray_blocks.h"

using namespace castray;
using namespace castray::test;

// What glass absorbs by distance: where it bends nothing, by Beer and Lambert's law; else the kernels against
// castRay in double precision. Each `check` has a false-alarm rate of 1e-4.

namespace {

Material glass(const Vec3d& absorption, double ior) {
  return {.name = "glass", .type = MaterialType::dielectric, .absorption = absorption, .ior = ior};
}

const Vec3d outer{0.5, 1, 2}, inner{3, 0.2, 0};

/// Cubes of glass that bends nothing, of half sides 0.8 and 0.25, one in the other or by itself, under a
/// white sky, seen from z straight on by parallel rays through their middle.
Scene nested_cubes(double camera_z, bool with_inner) {
  SceneSketch sketch;
  sketch.add_cube(0.8, {0, 0, 0}, false, sketch.add_material(glass(outer, 1)));
  if (with_inner) sketch.add_cube(0.25, {0, 0, 0}, false, sketch.add_material(glass(inner, 1)));
  sketch.scene.environment = Vec3d(1);
  Camera parallel;
  parallel.projection = Projection::orthographic;
  parallel.half_height = 0.1;
  sketch.scene.camera = make_camera({0, 0, camera_z}, {0, 0, camera_z - 1}, {0, 1, 0}, 40, parallel);
  return sketch.scene;
}

void check_each_pixel(const Scene& scene, const Vec3d& depth) {
  RenderOptions options = wavefront_options(8, 1, 1);
  options.rr = 1;
  for (const Way& way : every_way(options)) {
    const Image image = render(scene, way.options).film.image();
    CAPTURE(way.name);
    for (const Vec3f& pixel : image.pixels)
      for (int c = 0; c < 3; ++c) REQUIRE(pixel[c] == Approx(std::exp(-depth[c])).epsilon(1e-5));
  }
}

/// A block of glass over a floor, with a dull and a rough metal cube and a lamp in it, and a lamp above it.
Scene filled_block(double alpha) {
  SceneSketch sketch;
  const auto floor = sketch.add_material({.name = "floor", .kd = Vec3d(0.6)});
  const auto dull = sketch.add_material({.name = "dull", .kd = {0.7, 0.5, 0.4}});
  const auto metal = sketch.add_material({.name = "metal", .type = MaterialType::conductor, .alpha = 0.3});
  Material lamp_material{.name = "lamp", .kd = Vec3d(0), .ke = {3, 2.5, 2}};
  lamp_material.two_sided_emission = true;
  const auto lamp = sketch.add_material(lamp_material);
  Material block = glass({2, 1, 0.3}, 1.5);
  block.alpha = alpha;
  const auto body = sketch.add_material(block);
  sketch.add_quad({-1, -0.6f, 1}, {1, -0.6f, 1}, {1, -0.6f, -1}, {-1, -0.6f, -1}, floor);
  sketch.add_cube(0.4, {0, -0.1, 0}, false, body);
  sketch.add_cube(0.12, {-0.2, -0.1, 0.1}, false, dull);
  sketch.add_cube(0.12, {0.2, -0.1, 0}, false, metal);
  sketch.add_quad({-0.15f, 0.2f, 0.1f}, {0.15f, 0.2f, 0.1f}, {0.15f, 0.2f, -0.2f}, {-0.15f, 0.2f, -0.2f},
                  lamp);
  sketch.add_quad({-0.6f, 0.95f, -0.6f}, {0.6f, 0.95f, -0.6f}, {0.6f, 0.95f, 0.6f}, {-0.6f, 0.95f, 0.6f},
                  lamp);
  sketch.scene.environment = {0.3, 0.35, 0.4};
  sketch.scene.camera = make_camera({0, 0.3, 2.2}, {0, -0.1, 0}, {0, 1, 0}, 44);
  return sketch.scene;
}

}  // namespace

TEST_CASE("glass that bends nothing dims what is behind it by its thickness, once") {
  check_each_pixel(nested_cubes(2, false), outer * 1.6);
  check_each_pixel(nested_cubes(2, true), outer * 1.1 + inner * 0.5);
  // From within: to the body's own surface, and behind another one in it.
  check_each_pixel(nested_cubes(0.5, false), outer * 1.3);
  check_each_pixel(nested_cubes(0.5, true), outer * 0.55 + inner * 0.5);
}

TEST_CASE("pictures do not depend on the unit of length that absorption counts in") {
  Scene scene = nested_cubes(2, true);
  scene.unit = 4;
  for (Material& m : scene.materials) m.absorption = m.absorption / 4;
  check_each_pixel(scene, outer * 1.1 + inner * 0.5);
}

TEST_CASE("kernels absorb in glass as castRay does, however paths are shared", "[statistical]") {
  for (const double alpha : {0., 0.2}) {
    const Scene scene = filled_block(alpha);
    const Expected expected(scene, wavefront_options(16), 16);
    // two paths of one pixel may find a lamp and the sky: added in their order, whatever the width
    if (alpha > 0) expected.check_each_kernel(scene);
    for (const Switch caustics : {Switch::on, Switch::off})
      for (const bool shared : {true, false})
        expected.check_with("caustics, shared", scene, [&](RenderOptions& o) {
          o.caustics = caustics;
          o.reuse = {.automatic = false,
                     .width = shared ? 8 : 0,
                     .height = shared ? 8 : 0,
                     .suffixes = shared ? 64 : 0};
        });
  }
}
