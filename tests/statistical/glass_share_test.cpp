#include <catch2/catch.hpp>

#include <cmath>

#include "castray_blocks.h"
#include "instanced.h"

using namespace castray;
using namespace castray::test;

// Principled materials of which a share is glass: the kernels against castRay in double precision, and
// castRay against the parts. Each `check` has a false-alarm rate of 1e-4.

namespace {

/// As SceneBuilder makes it.
std::uint16_t add_glazed(SceneSketch& sketch, double transmission, double alpha) {
  Material m{.name = "glazed", .type = MaterialType::principled, .kd = {0.8, 0.6, 0.4}, .alpha = alpha};
  m.ks = Vec3d(0.05);
  m.metallic = 0.2;
  m.clearcoat = 0.5;
  m.transmission = transmission;
  Material glass{.name = "glass", .type = MaterialType::dielectric, .transmittance = m.kd, .alpha = alpha};
  glass.absorption = {0.5, 1, 2};
  m.glass = sketch.add_material(glass);
  return sketch.add_material(m);
}

/// A block on a floor, under a lamp and a sky.
Scene glazed_block(double alpha) {
  SceneSketch sketch;
  const auto floor = sketch.add_material({.name = "floor", .kd = Vec3d(0.6)});
  const auto lamp = sketch.add_material({.name = "lamp", .kd = Vec3d(0.2), .ke = {9, 8, 7}});
  const auto glazed = add_glazed(sketch, 0.6, alpha);
  sketch.add_quad({-1, -0.5f, 1}, {1, -0.5f, 1}, {1, -0.5f, -1}, {-1, -0.5f, -1}, floor);
  sketch.add_quad({-.6f, 1, .5f}, {-.6f, 1, -.5f}, {.6f, 1, -.5f}, {.6f, 1, .5f}, lamp);
  sketch.add_cube(0.38, {0, -0.11, 0}, false, glazed);
  sketch.scene.environment = {0.2, 0.25, 0.3};
  sketch.scene.camera = make_camera({0.6, 1, 2.2}, {0, 0, 0}, {0, 1, 0}, 40);
  return sketch.scene;
}

/// Red, over the pixels, of a sheet of which a share is glass, in front of a sky.
Mean radiance_of_sheet(double transmission, const RenderOptions& options) {
  SceneSketch sketch;
  const auto glazed = add_glazed(sketch, transmission, 0.3);
  sketch.add_quad({-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, glazed);
  sketch.scene.environment = Vec3d(1);
  sketch.scene.camera = make_camera({0, 0, 2}, {0, 0, 0}, {0, 1, 0}, 20);
  Mean mean;
  const Image image = render(sketch.scene, options).film.image();
  for (const Vec3f& pixel : image.pixels) mean.add(static_cast<double>(pixel.x));
  return mean;
}

}  // namespace

TEST_CASE("kernels see what is glass in part as castRay does", "[statistical]") {
  const Scene rough = glazed_block(0.3);
  const Expected expected(rough);
  expected.check("shared", rough, wavefront_options(4));
  expected.check("plain", rough, plain(wavefront_options(8)));
  expected.check("instances", as_instances(rough, kinds_of_places()), wavefront_options(4));
  const Scene smooth = glazed_block(0);
  const Expected expected_smooth(smooth);
  expected_smooth.check("shared", smooth, wavefront_options(8));
  expected_smooth.check_with("light paths", smooth, [](RenderOptions& o) { o.caustics = Switch::on; });
}

// 2 z-tests at 4.5 sigma: a false alarm once in 70,000 seeds.
TEST_CASE("what is glass in part is the blend of its parts", "[statistical]") {
  RenderOptions options = wavefront_options(8, 4096, 1);
  options.rr = 1;
  for (const Way& way : {Way{"castRay", as_reference(options)}, Way{"plain", plain(options)}}) {
    const Mean opaque = radiance_of_sheet(0, way.options), half = radiance_of_sheet(0.5, way.options),
               most = radiance_of_sheet(1, way.options);
    const double blend = (opaque.mean() + most.mean()) / 2;
    const double error = std::hypot(half.error(), opaque.error() / 2, most.error() / 2);
    CAPTURE(way.name, half.mean(), blend, error);
    CHECK(std::abs(half.mean() - blend) < 4.5 * error);
    CHECK(error < 0.01 * blend);
    CHECK(opaque.mean() > 2 * most.mean());  // of which the interior absorbs what passes
  }
}
