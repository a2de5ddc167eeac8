#include "lights/light_share.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

#include "test_scenes.h"

using namespace castray;
using namespace castray::test;

namespace {

/// A dim lamp of side 1 that shines down from y = 0, and a plate of side 0.2 that much below its middle.
Scene lamp_over_plate(double below, const Material& plate, bool two_sided = false) {
  SceneSketch sketch;
  Material lamp{.name = "lamp", .ke = Vec3d(.01, .02, .03)};
  lamp.two_sided_emission = two_sided;
  const auto shining = sketch.add_material(lamp), lit = sketch.add_material(plate);
  const auto y = static_cast<float>(-below);
  sketch.add_quad({-.5f, 0, -.5f}, {.5f, 0, -.5f}, {.5f, 0, .5f}, {-.5f, 0, .5f}, shining);
  sketch.add_quad({-.1f, y, -.1f}, {-.1f, y, .1f}, {.1f, y, .1f}, {.1f, y, -.1f}, lit);
  return sketch.scene;
}

const Material diffuse{.name = "plate", .kd = Vec3d(0.5)};

bool automatic(const Scene& scene, double bsdf_samples) {
  return uses_mis(Switch::automatic, scene, bsdf_samples);
}

}  // namespace

TEST_CASE(
    "light and BSDF sampling share all of the emission, and light sampling keeps what it is denser for") {
  for (double light : {1e-30, 0.3, 1.0, 7.0, 1e20})
    for (double bsdf : {1e-30, 0.3, 1.0, 7.0, 1e20}) {
      CAPTURE(light, bsdf);
      CHECK(light_share(light, bsdf) + bsdf_share(light, bsdf) == Approx(1).epsilon(1e-15));
      CHECK(light_share(light, bsdf) / light <= std::min(1 / light, 1 / bsdf) * (1 + 1e-15));
      CHECK((light_share(light, bsdf) == 1) == (light >= bsdf));
    }
  CHECK(light_share(1., 4.) == 0.25);
}

TEST_CASE("MIS is left out only where light sampling is denser everywhere") {
  const double closest =
      std::sqrt(8 / std::numbers::pi);  // 8 / (pi d^2) is the density 1 of the lamp's points
  CHECK_FALSE(automatic(lamp_over_plate(1.01 * closest, diffuse), 8));
  CHECK(automatic(lamp_over_plate(0.99 * closest, diffuse), 8));
  CHECK_FALSE(automatic(lamp_over_plate(0.99 * closest, diffuse), 1));
  CHECK_FALSE(automatic(lamp_over_plate(-0.1, diffuse), 8));  // behind the lamp
  CHECK(automatic(lamp_over_plate(-0.1, diffuse, true), 8));
  CHECK(uses_mis(Switch::on, lamp_over_plate(9, diffuse), 1));
  CHECK_FALSE(uses_mis(Switch::off, lamp_over_plate(0.1, diffuse), 1));
}

TEST_CASE("any lobe that can be narrower than the cosine's has MIS, if a triangle uses it") {
  for (const MaterialType type :
       {MaterialType::conductor, MaterialType::microfacet, MaterialType::dielectric}) {
    Material other = diffuse;
    other.type = type;
    CHECK(automatic(lamp_over_plate(9, other), 1));
    Scene unused = lamp_over_plate(9, diffuse);
    unused.materials.push_back(other);
    CHECK_FALSE(automatic(unused, 1));
  }
}

TEST_CASE("where MIS is left out it would not change a bit of the image") {
  const Scene box = standard_scene("cornell_box");
  RenderOptions options;
  options.width = options.height = 40;
  options.spp = 4;
  options.mis = Switch::automatic;
  for (const bool shared : {true, false}) {
    options.reuse.automatic = shared;
    REQUIRE_FALSE(automatic(box, 8));
    const RenderResult left_out = render(box, options);
    RenderOptions with = options;
    with.mis = Switch::on;
    CHECK(left_out.film.image().pixels == render(box, with).film.image().pixels);
  }
}
