#include <catch2/catch.hpp>

#include <set>

#include "castray/error.h"
#include "render/block_noise.h"
#include "render/prepared_scene.h"
#include "test_scenes.h"

using namespace castray;
using namespace castray::test;
using Catch::Contains;

namespace {

RenderOptions to_target(double target, std::uint64_t most = 4096) {
  RenderOptions options;
  options.width = 100;
  options.height = 70;
  options.target_error = target;
  options.spp = most;
  return options;
}

RenderOptions without_target(RenderOptions options, std::uint64_t spp) {
  options.target_error.reset();
  options.reconstruct = Switch::off;
  options.spp = spp;
  return options;
}

/// Two films of 64 x 32 pixels, of 4 samples each: red noise of +-`left` and +-`right` in the two blocks
/// around 1.
struct TwoFilms {
  Film films[2];

  TwoFilms(float left, float right) {
    for (int side = 0; side < 2; ++side) {
      films[side] = Film({64, 32, 0, 0, 64, 32}, 4);
      for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 64; ++x)
          for (int i = 0; i < 4; ++i)
            films[side].add(x, y, {1 + (side ? 1.f : -1.f) * (x < 32 ? left : right), 0, 0});
    }
  }
  BlockNoise noise() const { return {films[0], films[1], map()}; }
  SampleMap map() const { return {films[0].window(), {0, 1}}; }
};

}  // namespace

TEST_CASE("a sample map counts the samples of pixels, rows and blocks") {
  const Window window{200, 100, 30, 40, 100, 70};  // 4 x 2 blocks: columns of 2, 32, 32, 4 pixels
  SampleMap map(window, {10, 3});
  REQUIRE(map.blocks() == 8);
  CHECK(map.total() == 70u * 30 * 3);
  CHECK(map.wants_any(0, 0, 8, 8, 12));
  map.set_counts({1, 2, 3, 4, 5, 6, 7, 8});
  CHECK(map.range() == SampleRange{10, 8});
  CHECK(map.total() == 24u * (2 * 1 + 32 * 2 + 32 * 3 + 4 * 4) + 6u * (2 * 5 + 32 * 6 + 32 * 7 + 4 * 8));
  CHECK(map.total(63, 65, {12, 3}) == (32u * 1 + 4 * 2) + 3 * (2u + 32 + 32 + 4));
  CHECK(map.wants(31, 40, 10));
  CHECK_FALSE(map.wants(31, 40, 11));
  CHECK(map.wants(99, 69, 17));
  CHECK(map.wants_any(28, 40, 36, 48, 11));
  CHECK_FALSE(map.wants_any(24, 40, 32, 48, 11));
  CHECK_FALSE(map.wants_any(0, 0, 30, 40, 10));  // outside
}

TEST_CASE("noise is what two films differ by, held to their radiance") {
  const TwoFilms two(0.1f, 0.f);
  // variance of the mean of 8: 0.01; of a sample: 0.08; relMSE / 3 as two channels are black
  const double noise = 0.08 / 3 / (1.1 * 0.9 + 0.01);
  const double least = noise / 2 / 64;
  SampleMap map = two.map();
  CHECK(two.noise().expected_error(map) == Approx((noise + least) / 2).epsilon(1e-6));
  map.set_counts({16, 4});
  CHECK(two.noise().expected_error(map) == Approx((noise / 16 + least / 4) / 2).epsilon(1e-6));
}

TEST_CASE("samples are planned in proportion to the root of the noise, until the target is met") {
  const BlockNoise noise = TwoFilms(0.1f, 0.05f).noise();
  const SampleMap plan = noise.plan(1e-5, 1u << 20);
  CHECK(noise.expected_error(plan) <= 1e-5);
  CHECK(noise.expected_error(plan) > 0.99e-5);
  CHECK(double(plan.count(0)) / double(plan.count(1)) == Approx(2).epsilon(0.02));
  const SampleMap capped = noise.plan(1e-5, 100);
  CHECK(capped.count(0) == 100);
  CHECK(capped.count(1) == 100);
  const BlockNoise calm = TwoFilms(0, 0).noise();
  CHECK(calm.plan(1e-9, 100).total() == 64 * 32);  // one each
  CHECK(calm.expected_error(capped) == 0);
}

TEST_CASE("each block of a render to a target error is that of a plain render") {
  const Scene scene = standard_scene("cornell_conductor");
  for (const Integrator integrator : {Integrator::wavefront, Integrator::reference}) {
    RenderOptions options = to_target(integrator == Integrator::wavefront ? 2e-3 : 0.2);
    options.integrator = integrator;
    const RenderResult adaptive = render(scene, options);
    REQUIRE(adaptive.stats.stopped == Stopped::target_error);
    std::uint64_t paths = adaptive.stats.pilot_paths;
    std::set<std::uint32_t> counts;
    for (int y = 0; y < 70; y += 35)
      for (int x = 0; x < 100; x += 33) counts.insert(adaptive.film.count(x, y));
    CHECK(counts.size() > 1);
    for (int y = 0; y < 70; ++y)
      for (int x = 0; x < 100; ++x) {
        paths += adaptive.film.count(x, y);
        CHECK(adaptive.film.count(x, y) ==
              adaptive.film.count(x / SampleMap::block_side * SampleMap::block_side,
                                  y / SampleMap::block_side * SampleMap::block_side));
      }
    CHECK(paths == adaptive.stats.paths);
    for (const std::uint32_t n : counts) {
      const Film whole = render(scene, without_target(options, n)).film;
      for (int y = 0; y < 70; ++y)
        for (int x = 0; x < 100; ++x)
          if (adaptive.film.count(x, y) == n) REQUIRE(adaptive.film.mean(x, y) == whole.mean(x, y));
    }
  }
}

TEST_CASE("threads do not show in a render to a target error, nor in a crop of it") {
  const Scene scene = standard_scene("cornell_box");
  RenderOptions options = to_target(1e-3);
  options.crop = Window{0, 0, 11, 6, 90, 61};
  options.threads = 1;
  const RenderResult one = render(scene, options);
  options.threads = 3;
  const RenderResult three = render(scene, options);
  CHECK(one.film.image().pixels == three.film.image().pixels);
  CHECK(one.stats.paths == three.stats.paths);
  for (int y = 6; y < 61; ++y)
    for (int x = 11; x < 90; ++x) REQUIRE(one.film.count(x, y) == three.film.count(x, y));
}

TEST_CASE("a target that the most samples cannot reach is told") {
  const RenderResult result = render(standard_scene("cornell_box"), to_target(1e-7, 20));
  CHECK(result.stats.stopped == Stopped::done);
  CHECK(result.stats.expected_error.value() > 1e-7);
  CHECK(result.film.count(50, 50) == 20);
}

TEST_CASE("a render to a target error that is stopped early leaves a whole image") {
  const Scene scene = standard_scene("cornell_box");
  for (const double fraction : {0.0, 0.05, 0.5}) {
    const RenderResult result =
        render(scene, to_target(1e-5), [&](const Progress& p) { return p.fraction < fraction; });
    CHECK(result.stats.stopped == Stopped::interrupted);
    for (int y = 0; y < 70; ++y)
      for (int x = 0; x < 100; ++x) REQUIRE(result.film.count(x, y) > 0);
  }
}

TEST_CASE("what a target error contradicts is refused") {
  const Scene scene = standard_scene("cornell_box");
  const auto refused = [&](auto change, const char* words, const Film* start = nullptr) {
    RenderOptions options = to_target(1e-2);
    change(options);
    CHECK_THROWS_WITH(render(scene, options, {}, start), Contains("--target-error") && Contains(words));
  };
  refused([](RenderOptions& o) { o.target_error = 0; }, "above 0");
  refused([](RenderOptions& o) { o.samples = SampleRange{0, 4}; }, "--samples");
  RenderOptions faulty = to_target(1e-2);
  faulty.integrator = Integrator::reference;
  CHECK_THROWS_WITH(PreparedAccess::prepare(scene, faulty, Fault::black_light),
                    Contains("--target-error") && Contains("--fault"));
  const Film film;
  refused([](RenderOptions&) {}, "earlier film", &film);
}
