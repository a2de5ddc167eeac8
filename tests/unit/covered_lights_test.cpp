#include "lights/covered_lights.h"

#include <catch2/catch.hpp>

#include "generate/shapes.h"
#include "geometry/facets.h"
#include "test_scenes.h"

using namespace castray;
using namespace castray::test;

namespace {

bool covered(const Scene& scene) { return may_be_covered(scene, emitting_facets(scene)); }

/// A lamp of side 1 that shines down from y = 0, and a plate of side 0.2 at height y, `x` to the side.
Scene lamp_and_plate(float y, float x = 0, bool two_sided = false) {
  SceneSketch sketch;
  Material lamp{.name = "lamp", .ke = Vec3d(1)};
  lamp.two_sided_emission = two_sided;
  const auto shining = sketch.add_material(lamp), black = sketch.add_material({.name = "black"});
  sketch.add_quad({-.5f, 0, -.5f}, {.5f, 0, -.5f}, {.5f, 0, .5f}, {-.5f, 0, .5f}, shining);
  sketch.add_quad({x - .1f, y, -.1f}, {x + .1f, y, -.1f}, {x + .1f, y, .1f}, {x - .1f, y, .1f}, black);
  return sketch.scene;
}

}  // namespace

TEST_CASE("a light is covered by what is close in front of where it shines") {
  CHECK(covered(lamp_and_plate(-1e-6f)));
  CHECK_FALSE(covered(lamp_and_plate(-1e-4f)));
  CHECK_FALSE(covered(lamp_and_plate(1e-6f)));
  CHECK(covered(lamp_and_plate(1e-6f, 0, true)));
  CHECK_FALSE(covered(lamp_and_plate(0)));
  CHECK_FALSE(covered(lamp_and_plate(-1e-6f, 0.7f)));
}

TEST_CASE("the lights of the standard scenes are not covered, one of two spheres is") {
  for (const char* name :
       {"cornell_box", "cornell_conductor", "cornell_lights", "cornell_microfacet", "furnace"}) {
    CAPTURE(name);
    CHECK_FALSE(covered(standard_scene(name)));
  }
  SceneSketch spheres;
  const Shape sphere = icosphere(6);
  const auto lamp = spheres.add_material({.name = "lamp", .ke = Vec3d(1)}),
             black = spheres.add_material({.name = "black"});
  spheres.add_mesh(sphere.positions, sphere.triangles, 0.5, {}, true, lamp);
  CHECK_FALSE(covered(spheres.scene));
  spheres.add_mesh(sphere.positions, sphere.triangles, 0.5 * (1 - 1e-6), {}, false, black);
  CHECK(covered(spheres.scene));
}

TEST_CASE("a light of so many triangles that looking would take long counts as covered") {
  SceneSketch sketch;
  const Shape sphere = icosphere(16);
  const auto lamp = sketch.add_material({.name = "lamp", .ke = Vec3d(1)});
  sketch.add_mesh(sphere.positions, sphere.triangles, 0.5, {}, true, lamp);
  CHECK(covered(sketch.scene));
}
