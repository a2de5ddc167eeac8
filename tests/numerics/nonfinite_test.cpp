#include <catch2/catch.hpp>

#include <limits>

#include "integrators.h"
#include "materials/texture.h"
#include "test_scenes.h"

using namespace castray;
using namespace castray::test;

// Samples that are not finite are left out, counted and told; they change nothing else.

namespace {

constexpr int side = 32;
constexpr std::uint64_t spp = 64;

/// The Cornell box whose white has a texture of 400 x 400 texels on every triangle; one is `odd`.
Scene with_odd_texel(float odd) {
  Scene scene = standard_scene("cornell_box");
  Image white(400, 400);
  std::ranges::fill(white.pixels, Vec3f(1));
  white.at(120, 280) = Vec3f(odd);
  scene.textures.push_back(make_texture("white but for a speck", white));
  for (Material& material : scene.materials)
    if (material.name == "white") material.map(SurfaceParameter::kd).texture = 0;
  scene.uvs = {{0, 0}, {1, 0}, {0, 1}};
  scene.triangle_uvs.assign(scene.triangles.size(), {0, 1, 2});
  return scene;
}

std::vector<Way> ways() {
  RenderOptions options;
  options.width = options.height = side;
  options.spp = spp;
  std::vector<Way> ways;
  for (const Way& way : every_way(options))
    if (way.options.accel != AccelKind::list &&  // lists have no textures
        (way.options.isa == "auto" || way.options.isa == choose_kernel("auto").name))
      ways.push_back(way);
  return ways;
}

/// One sample of every pixel: a film of its own.
RenderResult one_sample(const Scene& scene, RenderOptions options, std::uint64_t sample) {
  options.samples = SampleRange{sample, 1};
  return render(scene, options);
}

}  // namespace

TEST_CASE("a BSDF that is rarely not a number costs the samples that meet it, and no other") {
  const Scene broken = with_odd_texel(std::numeric_limits<float>::quiet_NaN()), whole = with_odd_texel(1);
  for (const Way& way : ways()) {
    CAPTURE(way.name);
    std::uint64_t dropped = 0, told = 0;
    for (std::uint64_t sample = 0; sample < spp; ++sample) {
      const RenderResult with = one_sample(broken, way.options, sample),
                         without = one_sample(whole, way.options, sample);
      CHECK(without.film.nonfinite_samples == 0);
      dropped += with.film.nonfinite_samples;
      told += with.stats.nonfinite.size();
      std::uint64_t missing = 0;
      for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) {
          if (with.film.count(x, y) == 0)
            ++missing;
          else
            REQUIRE(with.film.mean(x, y) == without.film.mean(x, y));
        }
      REQUIRE(missing == with.film.nonfinite_samples);
      REQUIRE(with.stats.nonfinite.empty() == (missing == 0));
      for (const NonfiniteSample& bad : with.stats.nonfinite) {
        RenderOptions alone = way.options;
        alone.crop = Window{0, 0, bad.x, bad.y, bad.x + 1, bad.y + 1};
        REQUIRE(bad.sample == sample);
        REQUIRE(one_sample(broken, alone, sample).film.nonfinite_samples == 1);
      }
    }
    CHECK(dropped > 0);
    CHECK(dropped < spp * side * side / 50);
    CHECK(told > 0);
  }
}

TEST_CASE("no sample of the standard scenes is not finite, 4096 in each pixel", "[long]") {
  for (const char* name : {"cornell_box", "cornell_conductor", "cornell_lights", "cornell_microfacet",
                           "cornell_obj", "furnace", "one_triangle"})
    for (const Way& way : every_way({})) {
      const bool reference = way.options.integrator == Integrator::reference;
      if (!reference && way.options.isa != choose_kernel("auto").name) continue;
      RenderOptions options = way.options;
      options.width = options.height = reference ? 24 : 64;
      options.spp = 4096;
      CAPTURE(name, way.name);
      CHECK(render(standard_scene(name), options).film.nonfinite_samples == 0);
    }
}
