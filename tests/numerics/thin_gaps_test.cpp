#include <catch2/catch.hpp>

#include <algorithm>

#include "integrators.h"
#include "reference_images.h"
#include "test_scenes.h"

using namespace castray;
using namespace castray::test;

// Surfaces next to one another, and in one another.

namespace {

constexpr int side = 16;

RenderOptions small(std::uint64_t spp) {
  RenderOptions options;
  options.width = options.height = side;
  options.spp = spp;
  options.threads = 1;
  return options;
}

/// A horizontal rectangle, seen from above or from below.
void add_level(SceneSketch& sketch, float x0, float x1, float y, bool up, std::uint16_t material) {
  if (up)
    sketch.add_quad({x0, y, 1}, {x1, y, 1}, {x1, y, -1}, {x0, y, -1}, material);
  else
    sketch.add_quad({x0, y, -1}, {x1, y, -1}, {x1, y, 1}, {x0, y, 1}, material);
}

Image image_of(const Scene& scene, const RenderOptions& options) {
  const RenderResult result = render(scene, options);
  REQUIRE(result.film.nonfinite_samples == 0);
  return result.film.image();
}

}  // namespace

TEST_CASE("a plate lit by another at a thin gap is as bright as its albedo") {
  for (const float gap : {1e-2f, 1e-4f, 1e-5f}) {
    SceneSketch sketch;
    add_level(sketch, -1, 1, 0, true, sketch.add_material({.name = "plate", .kd = Vec3d(0.5)}));
    add_level(sketch, -1, 1, gap, false, sketch.add_material({.name = "lamp", .kd = {}, .ke = Vec3d(1)}));
    sketch.scene.camera = make_camera({0.1, gap / 2, 0.2}, {0.1, 0, 0.2}, {0, 0, 1}, 60);
    for (const Way& way : every_way(small(4))) {
      CAPTURE(gap, way.name);
      Mean mean;  // over seeds: pixels may share their noise
      RenderOptions options = way.options;
      for (options.seed = 1; options.seed <= 16; ++options.seed)
        mean.add(block_means(image_of(sketch.scene, options), side)[0]);
      CAPTURE(mean.mean(), mean.error());
      // the plates' ends, 1 / gap away, take less than 1e-4
      CHECK(std::abs(mean.mean() - 0.5) < 5 * mean.error() + 1e-4);
    }
  }
}

// 24 ways at most, each at a false-alarm rate of 1e-4.
TEST_CASE("a light 1e-4 of the scene's size below the ceiling lights as in double precision") {
  Scene scene = standard_scene("cornell_box");
  float ceiling = -1;
  for (const Vec3f& p : scene.positions) ceiling = std::max(ceiling, p.y);
  for (const std::uint32_t t : scene.lights)
    for (const std::uint32_t v : scene.triangles[t]) scene.positions[v].y = ceiling - 2e-4f;
  const auto blocks = [&](RenderOptions options, std::uint64_t first_seed) {
    std::vector<std::vector<double>> renders;
    for (std::uint64_t seed = 0; seed < 12; ++seed) {
      options.seed = first_seed + seed;
      renders.push_back(block_means(image_of(scene, options), 4));
    }
    return renders;
  };
  RenderOptions exact = small(64);
  exact.integrator = Integrator::reference;
  exact.precision = Precision::float64;
  std::vector<double> expected, variance;
  const auto reference = blocks(exact, 1);
  for (std::size_t i = 0; i < reference[0].size(); ++i) {
    Mean mean;
    for (const auto& render : reference) mean.add(render[i]);
    expected.push_back(mean.mean());
    variance.push_back(mean.error() * mean.error());
  }
  for (const Way& way : every_way(small(8))) {
    const BlockScores scores = block_scores(blocks(way.options, 100), expected, variance);
    CAPTURE(way.name, scores.rms);
    CHECK(scores.largest < score_limit(scores.count, 1e-4));
  }
}

TEST_CASE("where quads lie in one plane, the first one is seen") {
  SceneSketch sketch;
  const auto glow = [&](double e) { return sketch.add_material({.name = "glow", .kd = {}, .ke = Vec3d(e)}); };
  add_level(sketch, -1, 0.5f, 0, true, glow(1));
  add_level(sketch, -0.5f, 1, 0, true, glow(2));
  for (const Way& way : every_way(small(1))) {
    CAPTURE(way.name);
    for (const auto& [x, expected] : {std::pair{-0.8, 1.f}, {0., 1.f}, {0.8, 2.f}}) {
      sketch.scene.camera = make_camera({x, 1, 0}, {x, 0, 0}, {0, 0, 1}, 20);
      const Image image = image_of(sketch.scene, way.options);
      CHECK(std::ranges::all_of(image.pixels, [&](const Vec3f& pixel) { return pixel == Vec3f(expected); }));
    }
  }
}

TEST_CASE("a light in the plane of the ceiling lights as without the ceiling") {
  const auto room = [](bool ceiling) {
    SceneSketch sketch;
    const auto white = sketch.add_material({.name = "white", .kd = Vec3d(0.5)});
    const auto lamp = sketch.add_material({.name = "lamp", .kd = {}, .ke = Vec3d(1)});
    add_level(sketch, -1, 1, -0.5f, true, white);
    add_level(sketch, -0.3f, 0.3f, 0.7f, false, lamp);
    if (ceiling) add_level(sketch, -1, 1, 0.7f, false, white);
    sketch.scene.camera = make_camera({0, 0.5, 0.5}, {0.1, -0.5, 0}, {0, 1, 0}, 40);
    return sketch.scene;
  };
  for (const Way& way : every_way(small(2))) {
    CAPTURE(way.name);
    RenderOptions options = way.options;
    options.max_depth = 2;
    options.mis = Switch::off;
    const Image with = image_of(room(true), options), without = image_of(room(false), options);
    for (std::size_t i = 0; i < with.pixels.size(); ++i) {
      CHECK(with.pixels[i].x > 0);
      CHECK(with.pixels[i].x == Approx(without.pixels[i].x).epsilon(1e-4));
    }
  }
}
