#include <catch2/catch.hpp>

#include "castray/error.h"
#include "film_bytes.h"
#include "test_scenes.h"

using namespace castray;
using namespace castray::test;
using Catch::Contains;

// The film is the same, byte for byte, however the work is cut up.

namespace {

constexpr int side = 24;

RenderOptions options_of(std::uint64_t spp) {
  RenderOptions options = reference_options(side, side, spp);
  options.sampler = SamplerKind::sobol;
  return options;
}

}  // namespace

TEST_CASE("a film does not depend on the number of threads or the accelerator") {
  const Scene scene = standard_scene("cornell_microfacet");
  RenderOptions options = options_of(5);
  options.threads = 1;
  const std::string one = bytes(render(scene, options).film);
  for (const int threads : {2, 3, 7}) {
    options.threads = threads;
    CHECK(bytes(render(scene, options).film) == one);
  }
  options.accel = AccelKind::list;
  CHECK(bytes(render(scene, options).film) == one);
}

TEST_CASE("a crop is the window of the full image") {
  const Scene scene = standard_scene("cornell_box");
  RenderOptions options = options_of(3);
  const Film full = render(scene, options).film;
  options.crop = Window{0, 0, 5, 7, 11, 20};
  const Film crop = render(scene, options).film;
  REQUIRE(crop.width() == 6);
  REQUIRE(crop.height() == 13);
  for (int y = 7; y < 20; ++y)
    for (int x = 5; x < 11; ++x) REQUIRE(crop.mean(x, y) == full.mean(x, y));
}

TEST_CASE("films of disjoint samples merge to the film of all, in any order") {
  const Scene scene = standard_scene("cornell_box");
  RenderOptions options = options_of(10);
  const std::string whole = bytes(render(scene, options).film);
  const auto part = [&](std::uint64_t first, std::uint64_t count) {
    options.samples = SampleRange{first, count};
    return render(scene, options).film;
  };
  Film merged = part(7, 3);
  merged.merge(part(0, 4));
  merged.merge(part(4, 3));
  CHECK(bytes(merged) == whole);
}

TEST_CASE("a stopped render, resumed from its film, ends as if it had not been stopped") {
  const Scene scene = standard_scene("cornell_box");
  const RenderOptions options = options_of(20);
  const std::string whole = bytes(render(scene, options).film);
  for (const double fraction : {0.01, 0.3, 0.6}) {
    const RenderResult stopped =
        render(scene, options, [&](const Progress& progress) { return progress.fraction < fraction; });
    REQUIRE(stopped.stats.stopped == Stopped::interrupted);
    REQUIRE(stopped.stats.paths < 20u * side * side);
    const RenderResult resumed = render(scene, options, {}, &stopped.film);
    CHECK(resumed.stats.paths + stopped.stats.paths == 20u * side * side);
    CHECK(bytes(resumed.film) == whole);
  }
}

TEST_CASE("a checkpoint taken between passes resumes to the same film, with more samples too") {
  const Scene scene = standard_scene("cornell_box");
  const std::string whole = bytes(render(scene, options_of(13)).film);
  Film checkpoint;
  render(scene, options_of(6), [&](const Progress& progress) {
    if (progress.film) checkpoint = *progress.film;
    return true;
  });
  REQUIRE(checkpoint.count(0, 0) > 0);
  CHECK(bytes(render(scene, options_of(13), {}, &checkpoint).film) == whole);
}

TEST_CASE("the film of another render is not resumed") {
  const Scene scene = standard_scene("cornell_box");
  RenderOptions options = options_of(2);
  const Film film = render(scene, options).film;
  options.seed = 9;
  CHECK_THROWS_WITH(render(scene, options, {}, &film), Contains("another render"));
}

TEST_CASE("samples that are not finite are left out, counted, and can be rendered alone") {
  Scene scene = standard_scene("cornell_box");
  for (Material& material : scene.materials)
    if (material.name == "green") material.kd.x = std::numeric_limits<double>::quiet_NaN();
  RenderOptions options = options_of(8);
  const RenderResult result = render(scene, options);
  REQUIRE(result.film.nonfinite_samples > 0);
  REQUIRE_FALSE(result.stats.nonfinite.empty());
  std::uint64_t counted = 0;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      counted += result.film.count(x, y);
      REQUIRE(is_finite(result.film.mean(x, y)));
    }
  CHECK(counted + result.film.nonfinite_samples == 8u * side * side);

  const NonfiniteSample first = result.stats.nonfinite.front();
  options.crop = Window{0, 0, first.x, first.y, first.x + 1, first.y + 1};
  options.samples = SampleRange{first.sample, 1};
  CHECK(render(scene, options).film.nonfinite_samples == 1);
}

TEST_CASE("path edges are counted: 1 shows emitters, 2 direct light") {
  const Scene scene = standard_scene("cornell_box");
  RenderOptions options = options_of(4);
  const auto sum = [&](int depth) {
    options.max_depth = depth;
    double sum = 0;
    const Image image = render(scene, options).film.image();
    for (const Vec3f& pixel : image.pixels) sum += luminance(Vec3d(pixel));
    return sum;
  };
  options.crop = Window{0, 0, 8, 14, 16, 20};  // boxes and back wall
  CHECK(sum(1) == 0);
  const double direct = sum(2), once = sum(3), all = sum(0);
  CHECK(direct > 0);
  CHECK(once > direct);
  CHECK(all > once);
  options.crop = Window{0, 0, 12, 3, 13, 4};  // the light
  CHECK(sum(1) > 30);
}

TEST_CASE("an environment is seen once, directly and by every bounce") {
  SceneSketch sketch;
  const auto white = sketch.add_material({.name = "white", .kd = Vec3d(0.5)});
  sketch.add_quad({-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, white);
  sketch.scene.camera = make_camera({0, 0, 1}, {0, 0, 0}, {0, 1, 0}, 20);
  sketch.scene.environment = {2, 2, 2};
  const Image floor = render(sketch.scene, options_of(1)).film.image();
  for (const Vec3f& pixel : floor.pixels)
    REQUIRE(pixel.x == Approx(1));  // a flat wall sees nothing but the sky
  sketch.scene.camera = make_camera({0, 0, 1}, {0, 0, 2}, {0, 1, 0}, 20);
  for (const Vec3f& pixel : render(sketch.scene, options_of(1)).film.image().pixels) REQUIRE(pixel.x == 2);
}

TEST_CASE("emission is one-sided unless the material says otherwise") {
  for (const bool two_sided : {false, true}) {
    SceneSketch sketch;
    const auto lamp = sketch.add_material(
        {.name = "lamp", .kd = Vec3d(0), .ke = Vec3d(3), .two_sided_emission = two_sided});
    sketch.add_quad({-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, lamp);
    sketch.scene.camera = make_camera({0, 0, 1}, {0, 0, 0}, {0, 1, 0}, 20);
    CHECK(render(sketch.scene, options_of(1)).film.mean(3, 3).x == 3);
    sketch.scene.camera = make_camera({0, 0, -1}, {0, 0, 0}, {0, 1, 0}, 20);
    CHECK(render(sketch.scene, options_of(1)).film.mean(3, 3).x == (two_sided ? 3 : 0));
  }
}

TEST_CASE("options that contradict the scene or one another are refused") {
  const Scene scene = standard_scene("one_triangle");
  const auto refused = [&](auto change, const char* word) {
    RenderOptions options = options_of(1);
    change(options);
    CHECK_THROWS_WITH(render(scene, options), Contains(word));
  };
  refused([](RenderOptions& o) { o.spp = 0; }, "samples per pixel");
  refused([](RenderOptions& o) { o.crop = Window{0, 0, 5, 5, 5, 9}; }, "--crop");
  refused([](RenderOptions& o) { o.crop = Window{0, 0, 0, 0, side + 1, 2}; }, "--crop");
  refused([](RenderOptions& o) { o.rr = 0; }, "--rr");
  refused([](RenderOptions& o) { o.rr = 1.5; }, "--rr");
  refused([](RenderOptions& o) { o.epsilon = 0; }, "--epsilon");
  refused([](RenderOptions& o) { o.time_limit = -1; }, "--time-limit");
  refused([](RenderOptions& o) { o.width = 1 << 20; }, "--size");
  refused([](RenderOptions& o) { o.lights = LightSampling::tree; }, "--lights");
}
