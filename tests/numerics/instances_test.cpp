#include <catch2/catch.hpp>

#include "box_scenes.h"
#include "instanced.h"
#include "integrators.h"

using namespace castray;
using namespace castray::test;

namespace {

/// Two blobs in a room that glows.
Scene blobs_in_a_room() {
  SceneSketch sketch;
  const auto checked = sketch.add_material({.name = "checked", .kd = Vec3d(0.9)});
  const auto metal = sketch.add_material(
      {.name = "metal", .type = MaterialType::conductor, .reflectance = Vec3d(0.8), .alpha = 0.3});
  const auto glowing = sketch.add_material({.name = "glowing", .kd = Vec3d(0.5), .ke = Vec3d(1)});
  const Shape shape = blob(8, 1);
  sketch.add_cube(1, {}, true, glowing);
  sketch.add_mesh(shape.positions, shape.triangles, 0.3, {-0.35, 0, -0.4}, false, checked);
  sketch.add_mesh(shape.positions, shape.triangles, 0.35, {0.35, 0.1, -0.3}, false, metal);
  sketch.scene.camera = make_camera({0.1, 0.2, 0.9}, {0, 0, -0.4}, {0, 1, 0}, 60);
  return with_detail(sketch.scene);
}

}  // namespace

namespace {

/// How many numbers of pixels are not the same but for rounding.
int different(const Scene& a, const Scene& b, const RenderOptions& options) {
  const Image expected = render(a, options).film.image(), image = render(b, options).film.image();
  int differ = 0;
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    for (int c = 0; c < 3; ++c)
      differ += std::abs(image.pixels[i][c] - expected.pixels[i][c]) > 1e-3f * expected.pixels[i][c];
  return differ;
}

}  // namespace

// Normals are smooth, and none has z near 0, where the frames around them jump.
TEST_CASE("instances are what the same surfaces in scene space are, pixel by pixel") {
  const Scene flat = blobs_in_a_room();
  const Scene instanced = as_instances(flat, kinds_of_places());
  RenderOptions options = wavefront_options(32, 4, 1);
  options.mis = Switch::on;
  options.max_depth = 3;
  for (const Way& way : every_way(options)) {
    if (way.options.accel == AccelKind::list) continue;
    CAPTURE(way.name);
    // where paths are shared, rounding decides at outlines which of them a pixel sees
    const bool shares = way.options.integrator != Integrator::reference && way.options.reuse.automatic;
    CHECK(different(flat, instanced, way.options) <= (shares ? 30 : 0));
  }
}
