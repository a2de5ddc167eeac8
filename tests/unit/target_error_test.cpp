#include <catch2/catch.hpp>

#include <cmath>
#include <functional>
#include <set>

#include "castray/error.h"
#include "castray/metrics.h"
#include "core/sequences.h"
#include "render/block_noise.h"
#include "render/prepared_scene.h"
#include "render/take_samples.h"
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

RenderOptions samples_of(RenderOptions options, const SampleRange& samples) {
  options.target_error.reset();
  options.reconstruct = Switch::off;
  options.samples = samples;
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
  BlockNoise noise() const { return {PixelNoise(films[0], films[1]), map()}; }
  SampleMap map() const { return {films[0].window(), {0, 4}}; }
};

/// Renders any radiance of pixel and sample index.
class FakeIntegrator final : public PreparedIntegrator {
 public:
  explicit FakeIntegrator(std::function<float(int x, int y, std::uint64_t sample)> radiance)
      : radiance_(std::move(radiance)) {}

  BandWork work(const Job&) const override {
    return {.render = [this](int y0, int y1, const SampleRange& range, const SampleMap& map, Film& film,
                             RowStats&) {
      for (int y = y0; y < y1; ++y)
        for (int x = 0; x < film.width(); ++x)
          for (std::uint64_t s = range.first; s < range.first + range.count; ++s)
            if (map.wants(x, y, s)) film.add(x, y, Vec3f(radiance_(x, y, s)));
    }};
  }
  void describe(const Film&, RenderStats&) const override {}

 private:
  std::function<float(int, int, std::uint64_t)> radiance_;
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
  map.set_counts({1, 1});
  CHECK(two.noise().expected_error(map) == Approx((noise + least) / 2).epsilon(1e-6));
  map.set_counts({16, 4});
  CHECK(two.noise().expected_error(map) == Approx((noise / 16 + least / 4) / 2).epsilon(1e-6));
  CHECK(PixelNoise(two.films[0], two.films[1]).at(3, 5) == Approx(noise));
}

TEST_CASE("an outlier does not shrink its own error") {
  TwoFilms two(0.1f, 0.1f);
  two.films[0].add(10, 10, {400, 0, 0});
  const double a = (4 * 0.9 + 400) / 5, b = 1.1;
  const double variance = (a - b) * (a - b) / (1. / 5 + 1. / 4);
  const double held_to_own_product = variance / 3 / (a * b + 0.01), held_to_truth = variance / 3 / 1.01;
  const double noise = PixelNoise(two.films[0], two.films[1]).at(10, 10);
  CHECK(noise > 15 * held_to_own_product);
  CHECK(noise < held_to_truth);
}

TEST_CASE("noise that fell as samples grew is expected to fall further") {
  const TwoFilms noisy(0.2f, 0.2f), calmer(0.1f, 0.1f);
  SampleMap few = noisy.map(), more = noisy.map();
  few.set_counts({1, 1});
  more.set_counts({64, 64});
  const BlockNoise before(PixelNoise(noisy.films[0], noisy.films[1]), few);
  BlockNoise after(PixelNoise(calmer.films[0], calmer.films[1]), more);
  const double fall = after.fall_from(before);  // to a quarter over 64 times the samples, less 0.1 for chance
  CHECK(fall == Approx(1. / 3 - 0.1).epsilon(0.1));
  CHECK(before.fall_from(after) == 0);
  BlockNoise known = after;
  known.set_fall(0.3);
  CHECK(after.fall_from(known) == 0.3);  // of as many samples
  SampleMap map = more;
  map.set_counts({1024, 1024});
  const double without = after.expected_error(map);
  after.set_fall(fall);
  CHECK(after.expected_error(map) == Approx(without * std::pow(8, -fall)));  // halves of 512
}

TEST_CASE(
    "the first pilot's noise falls as far as its two samples cancel, which a rare bright one does not") {
  const Window window{32, 32, 0, 0, 32, 32};
  const auto fall = [&](float second, float bright) {  // samples of 1 +- 0.1, then 1 -+ 0.1 `second`
    Film films[2], first[2];
    for (int side = 0; side < 2; ++side) {
      const float error = side ? 0.1f : -0.1f;
      first[side] = Film(window, 2);
      films[side] = Film(window, 2);
      for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 32; ++x) {
          const float extra = side == 0 && x == 3 && y == 5 ? bright : 0;
          first[side].add(x, y, Vec3f(1 + error + extra));
          films[side].add(x, y, Vec3f(1 + error + extra));
          films[side].add(x, y, Vec3f(1 - error * second));
        }
    }
    return fall_from_first(films[0], films[1], first[0], first[1]);
  };
  // the noise of one sample from 1 + s^2 to (1 - s)^2, less 0.1 for chance
  CHECK(fall(0.1f, 0) == Approx(std::log2(1.01 / 0.81) - 0.1).epsilon(1e-3));
  CHECK(fall(0.9f, 0) == 0.5);
  CHECK(fall(-1, 0) == 0);
  CHECK(fall(0, 0) == 0);
  CHECK(fall(0, 1000) == 0);
}

TEST_CASE("samples are planned in proportion to the root of the noise, until the target is met") {
  const BlockNoise noise = TwoFilms(0.1f, 0.05f).noise();
  const SampleMap plan = noise.plan(1e-5, 4, 1u << 20);
  CHECK(noise.expected_error(plan) <= 1e-5);
  CHECK(noise.expected_error(plan) > 0.99e-5);
  CHECK(double(plan.count(0)) / double(plan.count(1)) == Approx(2).epsilon(0.02));
  const SampleMap capped = noise.plan(1e-5, 4, 100);
  CHECK(capped.count(0) == 100);
  CHECK(capped.count(1) == 100);
  const BlockNoise calm = TwoFilms(0, 0).noise();
  CHECK(calm.plan(1e-9, 4, 100).total() == 64 * 32 * 4);  // the fewest
  CHECK(calm.plan(1e-9, 4, 2).total() == 64 * 32 * 2);
  CHECK(calm.expected_error(capped) == 0);
}

TEST_CASE("each block of a render to a target error is that of two plain renders, merged") {
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
      Film whole = render(scene, samples_of(options, {0, n - n / 2})).film;
      whole.merge(render(scene, samples_of(options, {replicate_length, n / 2})).film);
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

TEST_CASE("bright samples that only the image saw make the target missed") {
  for (const bool rare : {false, true}) {
    // the image's samples are those of replicates 0 and 1
    const auto radiance = [&](int x, int y, std::uint64_t sample) {
      const std::uint32_t h =
          hash_combine(hash_combine(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y)),
                       static_cast<std::uint32_t>(sample));
      const bool bright = rare && sample < 2 * replicate_length && h % 5000 == 0;
      return bright ? 200.f : 1 + .5f * static_cast<float>(static_cast<std::int32_t>(h)) / 2147483648.f;
    };
    const FakeIntegrator integrator(radiance);
    const Job job = make_job(facts_of(standard_scene("cornell_box")), to_target(2e-3));
    const RenderStats stats = take_samples(job, {}, nullptr, integrator).stats;
    CAPTURE(rare, stats.expected_error.value());
    CHECK((stats.stopped == Stopped::done) == rare);
    CHECK((*stats.expected_error > 2.8e-3) == rare);
  }
}

TEST_CASE("a render to a target error that is stopped early leaves a whole image") {
  const Scene scene = standard_scene("cornell_box");
  for (const double fraction : {0.0, 0.01, 0.05, 0.5}) {
    const RenderResult result =
        render(scene, to_target(1e-5), [&](const Progress& p) { return p.fraction < fraction; });
    CHECK(result.stats.stopped == Stopped::interrupted);
    for (int y = 0; y < 70; ++y)
      for (int x = 0; x < 100; ++x) REQUIRE(result.film.count(x, y) > 0);
  }
}

TEST_CASE("where means need many samples, images are reconstructed to the error asked for, from fewer") {
  const Scene scene = standard_scene("cornell_box");
  RenderOptions options = to_target(2e-4);
  options.width = options.height = 96;
  RenderOptions reference_options = options;
  reference_options.target_error.reset();
  reference_options.seed = 100;
  reference_options.spp = 512;
  const PreparedScene prepared(scene, options);
  const Image reference = image_of(render(prepared, reference_options).film);
  double samples = 0;
  for (options.seed = 1; options.seed <= 4; ++options.seed) {
    const RenderResult result = render(prepared, options);
    REQUIRE(result.film.differences().kept());
    CHECK_THAT(result.film.key, Contains("differences=on"));
    CHECK_THAT(result.stats.kernel, Contains("image from differences"));
    const double error = measure_errors(image_of(result.film), reference, 1).relmse;
    CAPTURE(options.seed, error, result.stats.expected_error.value());
    CHECK(error > 0.6 * 2e-4);
    CHECK(error < 1.5 * 2e-4);
    CHECK(*result.stats.expected_error < 1.5 * error);
    CHECK(*result.stats.expected_error > error / 1.5);
    samples += result.film.samples_per_pixel() / 4;
  }
  options.reconstruct = Switch::off;
  options.seed = 1;
  CHECK(samples < 0.5 * render(prepared, options).film.samples_per_pixel());
}

TEST_CASE("where means need few samples, they are what a render to a target error makes, unless told") {
  const Scene scene = standard_scene("cornell_box");
  RenderOptions options = to_target(5e-3);
  options.width = options.height = 96;
  const RenderResult means = render(scene, options);
  CHECK_FALSE(means.film.differences().kept());
  CHECK_THAT(means.film.key, !Contains("differences=on"));
  CHECK_THAT(means.stats.kernel, Contains("image from means"));
  options.reconstruct = Switch::on;
  const RenderResult reconstructed = render(scene, options);
  CHECK(reconstructed.film.differences().kept());
  CHECK(reconstructed.stats.stopped == Stopped::target_error);
  CHECK(*reconstructed.stats.expected_error < *means.stats.expected_error);
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
