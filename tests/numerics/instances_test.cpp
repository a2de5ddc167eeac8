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

TEST_CASE("instances are as bright as the same surfaces in scene space") {
  const Scene flat = blobs_in_a_room();
  const Scene instanced = as_instances(flat, kinds_of_places());
  for (const std::string& isa : instruction_sets())
    for (const bool shared : {true, false}) {
      CAPTURE(isa, shared);
      RenderOptions options = wavefront_options(32, 4, 1);
      options.isa = isa;
      options.mis = Switch::on;
      options.max_depth = 3;
      options.reuse = shared ? Reuse{.automatic = false, .width = 8, .height = 8, .suffixes = 64}
                             : Reuse{.automatic = false};
      const Image expected = render(flat, options).film.image(),
                  image = render(instanced, options).film.image();
      Vec3d sum, difference;
      for (std::size_t i = 0; i < image.pixels.size(); ++i) {
        sum += Vec3d(expected.pixels[i]);
        difference += Vec3d(image.pixels[i]) - Vec3d(expected.pixels[i]);
      }
      for (int c = 0; c < 3; ++c) CHECK(std::abs(difference[c]) < 2e-3 * sum[c]);
    }
}
