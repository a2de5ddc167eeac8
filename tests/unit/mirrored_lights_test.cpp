#include "lights/mirrored_lights.h"

#include <catch2/catch.hpp>

#include "geometry/facets.h"
#include "lights/light_table.h"
#include "test_scenes.h"

using namespace castray;
using namespace castray::test;

namespace {

/// A square of side `size` at height y, around (x,0); its front up, or down.
void add_square(SceneSketch& sketch, float x, float y, float size, bool up, std::uint16_t material) {
  const float h = size / 2;
  const Vec3f a{x - h, y, -h}, b{x + h, y, -h}, c{x + h, y, h}, d{x - h, y, h};
  up ? sketch.add_quad(d, c, b, a, material) : sketch.add_quad(a, b, c, d, material);
}

/// A lamp of side 1 at height 2 that shines down, over a mirror at height 0.
std::vector<MirroredLight> images(double alpha, float mirror_size, bool mirror_up, int lamps = 1) {
  SceneSketch sketch;
  const auto lamp = sketch.add_material({.name = "lamp", .ke = Vec3d(3)});
  const auto metal = sketch.add_material({.name = "metal", .type = MaterialType::conductor, .alpha = alpha});
  for (int i = 0; i < lamps; ++i) add_square(sketch, 2 * static_cast<float>(i), 2, 1, false, lamp);
  add_square(sketch, 0, 0, mirror_size, mirror_up, metal);
  const LightTable table(sketch.scene, emitting_facets(sketch.scene), true, 1);
  return mirrored_lights(sketch.scene, table.lights());
}

}  // namespace

TEST_CASE("the image of a lamp is as far behind a mirror as the lamp is in front, and shines up") {
  const std::vector<MirroredLight> found = images(0, 4, true);
  REQUIRE(found.size() == 1);
  const MirroredLight& image = found.front();
  CHECK(image.center[1] == Approx(-2));
  CHECK(image.origin[1] == Approx(-2));
  CHECK(image.normal[1] == Approx(1));
  CHECK(image.area == Approx(1));
  CHECK(image.power == 1);
  for (int c : {0, 2}) CHECK(image.center[c] == Approx(0).margin(1e-6));
  const auto at = [](const float(&across)[3], const float(&edge)[3]) {
    return across[0] * edge[0] + across[1] * edge[1] + across[2] * edge[2];
  };
  CHECK(at(image.across1, image.edge1) == Approx(1));
  CHECK(at(image.across2, image.edge2) == Approx(1));
  CHECK(at(image.across1, image.edge2) == Approx(0).margin(1e-6));
  CHECK(at(image.across2, image.edge1) == Approx(0).margin(1e-6));
}

TEST_CASE("polished metal blurs the image of a lamp, rough metal has none") {
  const std::vector<MirroredLight> polished = images(0.05, 4, true);
  REQUIRE(polished.size() == 1);
  CHECK(polished.front().area > 1.5);
  CHECK(images(0.2, 4, true).empty());
}

TEST_CASE("mirrors that turn away from a lamp, or show little of it, have no image of it") {
  CHECK(images(0, 4, false).empty());
  CHECK(images(0, 0.5f, true).empty());
}

TEST_CASE("of many lamps a few have images") { CHECK(images(0, 4, true, 20).size() == most_mirrored_lights); }
