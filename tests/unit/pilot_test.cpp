#include <catch2/catch.hpp>

#include <limits>

#include "plan/plan.h"
#include "pretended_renders.h"
#include "test_scenes.h"

using namespace castray;
using namespace castray::test;

TEST_CASE("the pilot's gain of sharing is the ratio of variances times that of costs") {
  // at least 8 tiles of 64 pixels with 3 channels and a degree of freedom: a variance is known to 3.6 %, a
  // gain to 5 %; and shared paths are taken to fall behind by 1.5 where it is clear from single samples, by
  // 1.1 twice at least where it is not
  for (const auto& [ratio, behind] : {std::pair{0.5f, 1.5}, {1.f, 1.5}, {2.f, 1.21}}) {
    const auto gain = gain_of_sharing(sharing(), 512, 512, 1, pretended(0.1f, 0.1f * ratio, 0, 2000, 500));
    REQUIRE(gain);
    CHECK(*gain == Approx(ratio * ratio * 500 / 2000 / behind).epsilon(0.15));
  }
}

TEST_CASE("the pilot expects an error that falls faster than 1/N to go on doing so") {
  const auto gain = [](float taken_back) {
    return *gain_of_sharing(sharing(), 512, 512, 1,
                            pretended(0.1f, 0.1f, 0, 1000, 1000, 0, 0, 0, taken_back));
  };
  // of single samples 1.01 times as much variance, of means over pairs 0.81 times: twice this step to 64
  CHECK(gain(0.1f) == Approx(0.81 * 0.81 * 0.81 / (1.01 * 1.01)).epsilon(0.1));
  CHECK(gain(-0.2f) == Approx(1.44 / (1.1 * 1.1)).epsilon(0.09));  // that of plain paths falls more slowly
}

TEST_CASE("the pilot tries more where a wrong choice would lose more than that takes") {
  const auto samples = [](float plain_noise, int side) {  // of pixels, by each of two techniques
    int count = 0;
    const RenderJob render = pretended(0.1f, plain_noise, 0, 1000, 1000);
    const RenderJob job = [&](const KernelOptions& options, const TileJob& tile, TileResult& result) {
      count += tile.tiles * tile_pixels;
      render(options, tile, result);
    };
    gain_of_sharing(sharing(), side, side, 1, job);
    return count / 2;
  };
  constexpr int replicates = 2, first = 8 * tile_pixels * replicates, four = 4;
  CHECK(samples(1, 512) == first);
  CHECK(samples(0.03f, 512) == first);
  CHECK(samples(0.11f, 512) > first);
  CHECK(samples(0.11f, 512) <= first + 6 * four * first);
  CHECK(samples(1, 96) == first / 2);
  CHECK(samples(0.11f, 64) == first);  // of 64 tiles
  CHECK(samples(0.11f, 56) == 0);      // of 49
}

TEST_CASE("the pilot takes 3.5 % of 16 samples of plain paths, or what its first tiles take") {
  for (const std::uint64_t shared_rays : {1000, 5000, 20000})
    for (const int side : {64, 96, 128, 192, 256}) {
      constexpr std::uint64_t plain_rays = 1000;
      const RenderJob render = pretended(0.1f, 0.1f, 0, shared_rays, plain_rays);
      double rays = 0;
      const RenderJob job = [&](const KernelOptions& options, const TileJob& tile, TileResult& result) {
        const std::uint64_t before = result.rays;
        render(options, tile, result);
        rays += static_cast<double>(result.rays - before);
      };
      gain_of_sharing(sharing(), side, side, 1, job);
      const double tiles = side * side / double(tile_pixels), image = 16 * tiles * double(plain_rays);
      const double first = 2 * (side <= 128 ? 4 : 8) * double(shared_rays + plain_rays);
      CHECK(rays <= std::max(0.035 * image, first));
    }
}

namespace {

/// A tile's noise, alike in all of its pixels or each one's own, and one pixel in each tile that one sample
/// in 8 makes bright, which sharing leaves as it is or spreads over the tile.
RenderJob with_bright_samples(bool spread, std::uint64_t shared_rays) {
  return [=](const KernelOptions& options, const TileJob& job, TileResult& result) {
    const bool shared = options.suffixes > 0;
    for (std::uint32_t k = 0; k < static_cast<std::uint32_t>(job.tiles); ++k) {
      const bool bright = noise(options.seed, job, k, 0, 5) > 0.75f;
      for (std::uint32_t i = 0; i < tile_pixels; ++i)
        for (std::uint32_t c = 0; c < 3; ++c) {
          const float plain = shared && spread ? 0 : bright && i == 9 ? 40.f : 0;
          const float rest = shared ? 0.02f : 0.1f;
          const std::uint32_t whose = shared && spread ? 0 : i;
          result.radiance[c][k * tile_pixels + i] = 1 + plain + rest * noise(options.seed, job, k, whose, c);
        }
    }
    result.rays += (shared ? shared_rays : 1000) * static_cast<std::uint64_t>(job.tiles);
  };
}

}  // namespace

TEST_CASE("to the pilot, rare bright samples of single pixels are an error of shared and of plain paths") {
  // without them the gain would be 25 / 1.5 / 2
  CHECK(*gain_of_sharing(sharing(), 128, 128, 1, with_bright_samples(false, 2000)) < 0.6);
  CHECK(*gain_of_sharing(sharing(), 128, 128, 1, with_bright_samples(true, 2000)) > 20);
}

TEST_CASE("paths are shared if that does better by more than its error, or by much") {
  for (const auto& [gain, error, suffixes] :
       {std::tuple{1.3, 1.2, 64}, {1.3, 1.4, 0}, {0.9, 1.0, 0}, {1.6, 3.0, 64}}) {
    Plan plan;
    plan.suffixes = 64;
    choose_by_pilot(plan, gain, error);
    CHECK(plan.suffixes == suffixes);
  }
}

TEST_CASE("few suffixes are shared in doubt, but for where one may meet a very bright caustic") {
  for (const auto& [gain, error, light_paths, suffixes] : {std::tuple{1.1, 1.4, 0.0, 32},
                                                           {1.1, 1.4, 100.0, 32},
                                                           {0.9, 1.2, 0.0, 32},
                                                           {0.9, 1.0, 0.0, 0},
                                                           {0.8, 1.2, 0.0, 0},
                                                           {0.6, 3.0, 0.0, 0},
                                                           {1.4, 1.0, 300.0, 0},
                                                           {1.6, 3.0, 300.0, 32}}) {
    Plan plan;
    plan.suffixes = 64;
    plan.few_suffixes = 32;
    plan.gain_of_light_paths = light_paths;
    choose_by_pilot(plan, gain, error, true);
    CHECK(plan.suffixes == suffixes);
  }
}

TEST_CASE("few suffixes are not shared in doubt where all is known from single samples") {
  for (const auto& [gain, error, suffixes] : {std::tuple{1.1, 1.4, 0}, {1.5, 1.4, 32}, {1.6, 3.0, 32}}) {
    Plan plan;
    plan.suffixes = 64;
    plan.few_suffixes = 32;
    choose_by_pilot(plan, gain, error, true, true);
    CHECK(plan.suffixes == suffixes);
  }
}

TEST_CASE("to the pilot, noise that all techniques have alike is the camera's in matte scenes") {
  const RenderJob paths = pretended(0.02f, 0.1f, 0, 1000, 1000);
  const RenderJob job = [&](const KernelOptions& options, const TileJob& tile, TileResult& result) {
    paths(options, tile, result);
    for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(tile.tiles) * tile_pixels; ++i)
      for (std::uint32_t c = 0; c < 3; ++c)
        result.radiance[c][i] += 0.1f * noise(options.seed, tile, i / tile_pixels, i % tile_pixels, 9 + c);
  };
  const auto gain = [&](bool matte) {
    Pilot pilot{512, 512, true, 1, job};
    pilot.matte = matte;
    return *find_gains(pilot, sharing(), {.caustics = false, .sharing = true}, {}).sharing_by_chance;
  };
  // twice as much noise over 1.04 times; without what falls to an eighth, 1.125 over .165 and more of its own
  CHECK(gain(false) < 2);
  CHECK(gain(true) > 3.5);
  CHECK(gain(true) < 6);
}

TEST_CASE("to the pilot, plain paths with hardly any noise are as good as shared ones under narrow coats") {
  const auto gain = [](float noise, bool narrow_coats) {  // 25 / 1.5 without coats
    const RenderJob job = pretended(noise / 5, noise, 0, 1000, 1000);
    Pilot pilot{512, 512, true, 1, job};
    pilot.narrow_coats = narrow_coats;
    return *find_gains(pilot, sharing(), {.caustics = false, .sharing = true}, {}).sharing_by_chance;
  };
  CHECK(gain(0.1f, false) > 12);
  CHECK(gain(0.1f, true) < 1.3);
  CHECK(gain(1, true) > 5);
  Scene scene = standard_scene("cornell_box");
  const auto narrow = [&](const Material& m) {
    scene.materials[scene.triangle_material[0]] = m;
    return make_plan(scene, {}, {64, 64, 0, 0, 64, 64}).narrow_coats;
  };
  Material m;
  CHECK_FALSE(narrow(m));
  m.type = MaterialType::microfacet;
  m.alpha = 0.01;
  CHECK(narrow(m));
  m.alpha = 0.2;
  CHECK_FALSE(narrow(m));
  m.type = MaterialType::principled;
  CHECK_FALSE(narrow(m));
  m.clearcoat = 1;
  CHECK(narrow(m));
  m = {};
  m.type = MaterialType::conductor;
  m.alpha = 0.01;
  CHECK_FALSE(narrow(m));
}

TEST_CASE("half of the suffixes are taken where error times cost is less with them, unless all gain much") {
  // plain paths of 1000 rays, of which 630 are left without suffixes; noise by its greatest size
  const auto gains = [](bool few, std::uint64_t shared_rays, float plain_noise) {
    const RenderJob job = pretended(0.1f, plain_noise, 0, shared_rays, 1000);
    const OpenChoices open{.caustics = false, .sharing = true, .few = few};
    return find_gains({512, 512, true, 1, job}, sharing(), open, {});
  };
  CHECK_FALSE(gains(true, 1000, 0.1f).few_by_chance);
  CHECK(gains(true, 4000, 0.1f).few_by_chance);
  CHECK_FALSE(gains(false, 4000, 0.1f).few_by_chance);
  CHECK_FALSE(gains(true, 4000, 0.5f).few_by_chance);
  const auto gain = [&](bool few) { return *gains(few, 4000, 0.1f).sharing_by_chance; };
  CHECK(gain(true) / gain(false) == Approx(4 / (1.55 * (0.63 + 4) / 2)).epsilon(0.02));
}

TEST_CASE("to the pilot, what pixels gather costs less than rays, and BSDFs to evaluate cost something") {
  for (const bool list : {true, false}) {
    const auto gain = [list](std::uint64_t rays, std::uint64_t gathered, std::uint64_t evaluated,
                             std::uint64_t asked) {
      return *gain_of_sharing(sharing(), 256, 256, 1,
                              pretended(0.1f, 0.2f, 0, rays, 1000, gathered, evaluated, asked), list);
    };
    CHECK(gain(1000, 4000, 0, 0) < 0.95 * gain(1000, 0, 0, 0));
    CHECK(gain(1000, 4000, 0, 0) > 2 * gain(5000, 0, 0, 0));
    CHECK(gain(1000, 4000, 4000, 0) < 0.95 * gain(1000, 4000, 0, 0));
    CHECK(gain(1000, 4000, 0, 4000) < 0.5 * gain(1000, 4000, 0, 0));
    CHECK(gain(1000, 4000, 0, 4000) > gain(5000, 0, 0, 0));
  }
}

namespace {

/// Light paths of which each tenth brings one splat of this radiance, that chance would find as `by_chance`.
LightPathsJob pretended_light_paths(float radiance, float by_chance, std::uint64_t rays_of_path) {
  return [=](const KernelOptions&, const LightPathJob& job, const SplatSink& sink) {
    const std::uint32_t pixel = 3;
    for (int i = 0; i < job.count; ++i)
      if ((job.first + static_cast<std::uint64_t>(i)) % 10 == 0)
        sink.add(
            sink.self,
            {1, &pixel, &pixel, {&radiance, &radiance, &radiance}, {&by_chance, &by_chance, &by_chance}});
    return rays_of_path * static_cast<std::uint64_t>(job.count);
  };
}

/// Of a pilot of a square image that may choose everything.
Gains gains_with_light_paths(int side, const RenderJob& job, const LightPathsJob& light_paths) {
  KernelOptions options = sharing();
  options.light_paths = true;
  return find_gains({side, side, true, 2, job}, options, {.caustics = true, .sharing = true}, light_paths);
}

std::optional<double> gain_of_light_paths(int side, const RenderJob& job, const LightPathsJob& light_paths) {
  return gains_with_light_paths(side, job, light_paths).light_paths;
}

}  // namespace

TEST_CASE("the pilot's gain of light paths is the ratio of all variances times that of all costs") {
  const double noise = 0.3 * 0.3 / 3, plain_rays = 5;
  for (const float by_chance : {0.1f, 10.f, 1000.f})
    for (const std::uint64_t rays : {std::uint64_t{1}, std::uint64_t{20}}) {
      const auto gain = gain_of_light_paths(
          512, pretended(0.3f, 0.3f, 0, 64000, static_cast<std::uint64_t>(plain_rays * tile_pixels)),
          pretended_light_paths(2, by_chance, rays));
      REQUIRE(gain);
      const double splats = 1 / (1.2 * 1.2 + 0.01), rest = noise / 1.01;
      const double chance = 0.1 * 2 * by_chance * splats, light = 0.1 * 4 * splats;
      const double expected =
          (rest + chance) * plain_rays / ((rest + light) * (plain_rays + static_cast<double>(rays)));
      CHECK(*gain == Approx(expected).epsilon(0.05));  // the noise of 1536 differences, and its greatest ones
    }
  const RenderJob job = pretended(0.3f, 0.3f, 0, 64000, 320);
  CHECK_FALSE(gain_of_light_paths(512, job, pretended_light_paths(0, 1, 1)));
  CHECK_FALSE(gain_of_light_paths(56, job, pretended_light_paths(1, 1, 1)));
}

TEST_CASE("twice as many light paths halve the variance that these bring, and cost twice their rays") {
  const double rest = 0.3 * 0.3 / 3 / 1.01, plain_rays = 5;
  for (const float radiance : {0.5f, 2.f})
    for (const double rays : {1.0, 4.0}) {
      const Gains gains = gains_with_light_paths(
          512, pretended(0.3f, 0.3f, 0, 64000, static_cast<std::uint64_t>(plain_rays * tile_pixels)),
          pretended_light_paths(radiance, 1000, static_cast<std::uint64_t>(rays)));
      const double brightness = 1 + 0.1 * radiance;
      const double light = 0.1 * radiance * radiance * 3 / (brightness * brightness + 0.01);
      const double expected =
          (3 * rest + light) * (plain_rays + rays) / ((3 * rest + light / 2) * (plain_rays + 2 * rays));
      CAPTURE(radiance, rays);
      REQUIRE(gains.twice_with_plain);
      CHECK(*gains.twice_with_plain == Approx(expected).epsilon(0.02));
      CHECK(gains.twice_with_shared);
    }
  const RenderJob job = pretended(0.3f, 0.3f, 0, 64000, 320);
  CHECK_FALSE(gain_of_light_paths(56, job, pretended_light_paths(1, 1, 1)));

  const auto paths = [](bool light_paths, double gain) {
    Plan plan;
    plan.light_paths = light_paths;
    choose_number_of_light_paths(plan, gain);
    return plan.light_paths_per_pixel;
  };
  CHECK(paths(true, 1.3) == 2);
  CHECK(paths(true, 1.1) == 1);
  CHECK(paths(false, 1.3) == 1);
}

TEST_CASE("where tiles find caustics by chance, the pilot counts what sharing leaves of their variance") {
  const RenderJob quiet = pretended(0.1f, 0.1f, 0, 1000, 1000), loud = pretended(0.15f, 0.5f, 0, 1000, 1000);
  const RenderJob job = [=](const KernelOptions& options, const TileJob& tile, TileResult& result) {
    (options.light_paths ? quiet : loud)(options, tile, result);
  };
  const double rest = 0.01 / 1.01, splats = 3 / (1.02 * 1.02 + 0.01), rays = 1000.0 / tile_pixels;
  const double with = (rest + 0.1 * 0.04 * splats) * (rays + 1);
  const auto chance = [=](double b) { return 0.1 * 0.2 * b * splats; };
  const double left = 2 * (0.15 * 0.15 - 0.01) / (0.5 * 0.5 - 0.01);
  // a variance of 0.2, of which plain paths find 0.24; and of 2, which they have missed
  CHECK(*gain_of_light_paths(512, job, pretended_light_paths(0.2f, 3.5f, 1)) ==
        Approx((rest + chance(3.5) * left) * rays / with).epsilon(0.15));
  CHECK(*gain_of_light_paths(512, job, pretended_light_paths(0.2f, 35, 1)) ==
        Approx((rest + chance(35)) * rays / with).epsilon(0.05));
}

TEST_CASE("what the camera sees of emitters does not count in the pilot, nor does what is not finite") {
  const RenderJob quiet = pretended(0.1f, 0.2f, 0, 1000, 1000), loud = pretended(0.1f, 0.2f, 100, 1000, 1000);
  const auto expected = gain_of_sharing(sharing(), 256, 256, 1, quiet);
  CHECK(*gain_of_sharing(sharing(), 256, 256, 1, loud) == Approx(*expected).epsilon(1e-3));
  const RenderJob broken = [&](const KernelOptions& options, const TileJob& job, TileResult& result) {
    quiet(options, job, result);
    if (job.sample == 2) result.radiance[1][5] = std::numeric_limits<float>::infinity();
  };
  const auto gain = gain_of_sharing(sharing(), 256, 256, 1, broken);
  CHECK((gain && *gain > 0 && *gain < 100));
}

TEST_CASE("the pilot does not depend on threads or seed, and small or dark images have none") {
  const RenderJob job = pretended(0.1f, 0.2f, 0, 1000, 1000);
  KernelOptions other = sharing();
  other.seed = 77;
  const auto gain = gain_of_sharing(sharing(), 200, 136, 1, job);
  CHECK(gain == gain_of_sharing(sharing(), 200, 136, 3, job));
  CHECK(gain == gain_of_sharing(other, 200, 136, 1, job));
  CHECK_FALSE(gain_of_sharing(sharing(), 56, 64, 1, job));
  CHECK_FALSE(gain_of_sharing(sharing(), 200, 136, 1, pretended(0, 0, 0, 1000, 1000)));
}

namespace {

/// Pixels of 1 and noise, of which `alike` is the same for all of a tile and the rest each pixel's own. In
/// an eighth of the image, in the middle, down to row `rows`, all is their own, and so many times as large.
RenderJob partly_alike(float alike, float in_the_middle, std::uint64_t rays_of_pixel, int rows = 512) {
  return [=](const KernelOptions& options, const TileJob& job, TileResult& result) {
    for (std::uint32_t k = 0; k < static_cast<std::uint32_t>(job.tiles); ++k) {
      const bool middle = in_the_middle > 0 && x_of(job, k) / 64 == 4 && job.places[k].y < rows;
      const float shared = middle ? 0 : 0.1f * alike, own = middle ? 0.1f * in_the_middle : 0.1f - shared;
      for (std::uint32_t i = 0; i < tile_pixels; ++i)
        for (std::uint32_t c = 0; c < 3; ++c)
          result.radiance[c][k * tile_pixels + i] =
              1 + shared * noise(options.seed, job, k, 0, c) + own * noise(options.seed, job, k, i, 3 + c);
    }
    result.rays += rays_of_pixel * static_cast<std::uint64_t>(job.tiles) * tile_pixels;
  };
}

double gain_of_reconstruction(const RenderJob& job, bool list = true) {
  return *find_gains({512, 512, list, 2, job}, sharing(), {.reconstruction = true}, {})
              .reconstruction_by_chance;
}

}  // namespace

TEST_CASE("to the pilot, differences pay where neighbours' noise is alike, not if it is their own") {
  CHECK(gain_of_reconstruction(partly_alike(0.95f, 0, 20)) > 1.5);
  CHECK(gain_of_reconstruction(partly_alike(0.75f, 0, 20)) > 1.2);
  CHECK(gain_of_reconstruction(partly_alike(0.4f, 0, 20)) < 1);
  CHECK(gain_of_reconstruction(partly_alike(0, 0, 20)) == Approx(20 / (20 + 1 + 13 / 4.0)));
}

TEST_CASE("to the pilot, differences do not pay where samples cost little, or few tiles hold the noise") {
  CHECK(gain_of_reconstruction(partly_alike(0.95f, 0, 1)) < 1);
  CHECK(gain_of_reconstruction(partly_alike(0.95f, 0, 1), false) > 1);  // rays over a tree cost more
  CHECK(gain_of_reconstruction(partly_alike(0.95f, 10, 20)) < 1);
  CHECK(gain_of_reconstruction(partly_alike(0.95f, 10, 20, 128)) > 1.2);  // 1/32 of all do not decide
}
