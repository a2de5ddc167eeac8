#include "wavefront/pilot.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "castray/render.h"
#include "core/sequences.h"
#include "integrators.h"
#include "plan/plan.h"
#include "test_scenes.h"
#include "tracers.h"
#include "wavefront/kernel_scene.h"

using namespace castray;
using namespace castray::test;

namespace {

/// Of tile k of a job.
int x_of(const TileJob& job, std::uint32_t k) { return job.places[k].x; }

/// Uniform in [-1,1).
float noise(std::uint32_t seed, const TileJob& job, std::uint32_t tile, std::uint32_t pixel,
            std::uint32_t kind) {
  std::uint32_t h = hash_combine(seed, static_cast<std::uint32_t>(x_of(job, tile)));
  for (const std::uint32_t k :
       {static_cast<std::uint32_t>(job.places[tile].y), static_cast<std::uint32_t>(job.sample), pixel, kind})
    h = hash_combine(h, k);
  return static_cast<float>(h >> 8) * 0x1p-23f - 1;
}

/// A renderer whose pixels are 1 + what is seen of emitters, and noise of the given greatest size. Of a plain
/// sample's noise the other one of each two samples takes back `taken_back`. Rays are those of a tile.
RenderJob pretended(float shared_noise, float plain_noise, float emitted, std::uint64_t shared_rays,
                    std::uint64_t plain_rays, std::uint64_t gathered = 0, std::uint64_t evaluated = 0,
                    std::uint64_t asked = 0, float taken_back = 0) {
  return [=](const KernelOptions& options, const TileJob& job, TileResult& result) {
    const bool shared = options.suffixes > 0;
    TileJob other = job;
    other.sample ^= 1;
    const auto tiles = static_cast<std::uint32_t>(job.tiles);
    for (std::uint32_t k = 0; k < tiles; ++k)
      for (std::uint32_t i = 0; i < tile_pixels; ++i)
        for (std::uint32_t c = 0; c < 3; ++c) {
          const float seen = emitted * (1 + noise(options.seed, job, k, i, 7));
          const float of_sample = shared
                                      ? shared_noise * noise(options.seed, job, k, i, c)
                                      : plain_noise * (noise(options.seed, job, k, i, 3 + c) -
                                                       taken_back * noise(options.seed, other, k, i, 3 + c));
          result.radiance[c][k * tile_pixels + i] = seen + 1 + of_sample;
          result.emitted[c][k * tile_pixels + i] = seen;
        }
    result.rays += tiles * (shared ? shared_rays + gathered : plain_rays);
    result.gathered += tiles * (shared ? gathered : 0);
    result.asked += tiles * (shared ? asked : 0);
    result.evaluated += tiles * (shared ? evaluated : 0);
  };
}

KernelOptions sharing() {
  KernelOptions options{};
  options.suffixes = 64;
  options.ragged = 4;
  return options;
}

/// Of a pilot that has nothing else to choose.
std::optional<double> gain_of_sharing(const KernelOptions& options, int width, int height, int threads,
                                      const RenderJob& job, bool list = true) {
  return find_gains({width, height, list, threads, job}, options, {.caustics = false, .sharing = true}, {})
      .sharing_by_chance;
}

}  // namespace

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

TEST_CASE("few suffixes are shared in doubt, but for where bright caustics are most of the error") {
  for (const auto& [gain, error, light_paths, suffixes] : {std::tuple{1.1, 1.4, 0.0, 32},
                                                           {1.1, 1.4, 100.0, 32},
                                                           {0.9, 1.0, 0.0, 0},
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

TEST_CASE("an image with few suffixes by a pilot is that of as many given, and its film tells them") {
  const Scene floor = standard_scene("kinds/glossy_floor");
  RenderOptions options;
  options.width = options.height = 64;
  options.spp = 1;
  RenderOptions few = options;
  few.reuse = {.automatic = false, .width = 8, .height = 8, .suffixes = 32};
  const Film film = render(floor, options).film;
  CHECK_THAT(film.key, Catch::Contains("sharing=on; suffixes=32"));
  CHECK(describe(film).at("castray:suffixes") == "32");
  CHECK_THAT(describe(film).at("castray:options"), !Catch::Contains("--suffixes"));  // there is no such flag
  CHECK(film.image().pixels == render(floor, few).film.image().pixels);
}

namespace {

/// Where a job's pixels are, and their radiance.
using Rendered = std::pair<std::vector<std::uint32_t>, std::vector<float>>;

/// Jobs of a small image of glass on every kernel.
void with_kernels(const std::function<void(const std::function<Rendered(const TileJob&)>&)>& test) {
  const Scene box = standard_scene("kinds/glass_ball");
  RenderOptions options;
  const Plan plan = make_plan(box, options, {64, 64, 0, 0, 64, 64});
  const KernelSceneData data(box, plan, 64, 64, 1);
  for (const KernelApi* kernel : available_kernels()) {
    std::vector<std::uint8_t> memory(kernel->scratch_bytes + 64);
    void* scratch = &memory[64 - reinterpret_cast<std::uintptr_t>(memory.data()) % 64];
    test([&](const TileJob& job) {
      std::vector<std::uint32_t> place(2 * batch_size);
      std::vector<float> radiance(3 * batch_size);
      TileResult result{&place[0],
                        &place[batch_size],
                        {&radiance[0], &radiance[batch_size], &radiance[2 * batch_size]},
                        0,
                        0,
                        0,
                        0};
      KernelOptions k = sharing();
      k.ragged = 0;
      k.sobol = k.jitter = true;
      k.light_points = 8;
      k.most_indirect = std::numeric_limits<float>::infinity();
      kernel->render_tiles[plan.features](data.view, k, job, scratch, result);
      return Rendered{place, radiance};
    });
  }
}

TileJob job_of(std::span<const TilePlace> places, std::uint64_t sample) {
  TileJob job{};
  job.tiles = static_cast<int>(places.size());
  job.sample = sample;
  job.places = places.data();
  return job;
}

}  // namespace

TEST_CASE("tiles of one job that lie apart are as those that lie alone") {
  with_kernels([](const auto& render) {
    const std::array<TilePlace, 3> places{{{8, 16, 2, 2}, {40, 0, 5, 1}, {24, 56, 3, 7}}};
    const auto [all_at, all] = render(job_of(places, 5));
    for (std::size_t k = 0; k < places.size(); ++k) {
      const TilePlace& p = places[k];
      const auto [at, alone] = render({p.x, p.y, p.grid_x, p.grid_y, 1, 5});
      for (std::size_t i = 0; i < tile_pixels; ++i) {
        const std::size_t j = k * tile_pixels + i;
        REQUIRE((all_at[j] == at[i] && all_at[batch_size + j] == at[batch_size + i]));
        for (std::size_t c = 0; c < 3; ++c) REQUIRE(all[c * batch_size + j] == alone[c * batch_size + i]);
      }
    }
  });
}

TEST_CASE("repeats of a tile count up one sequence") {
  with_kernels([](const auto& render) {
    const auto take = [&](std::uint64_t sample, std::uint32_t repeat, std::uint32_t repeats) {
      const TilePlace place{8, 16, 2, 2, repeat, repeats};
      return render(job_of({&place, 1}, sample)).second;
    };
    const std::vector<float> twelfth = take(6, 0, 2);
    CHECK(twelfth == take(3, 0, 4));
    CHECK(twelfth == take(2, 2, 5));
    CHECK(twelfth != take(6, 1, 2));
    CHECK(twelfth != take(12, 0, 1));  // samples without repeats have a sequence of their own
  });
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

TEST_CASE(
    "paths from lights bring the caustics of small lamps by default, and chance what black mirrors throw") {
  RenderOptions options;
  options.width = options.height = 64;
  options.spp = 1;
  for (const char* name : {"kinds/glass_ball_small_lamp", "kinds/smooth_glass_ball"})
    CHECK_THAT(render(standard_scene(name), options).film.key, Catch::Contains("; light-paths=on"));
  Scene scene = standard_scene("kinds/facing_mirrors");
  for (Material& m : scene.materials)
    if (m.type == MaterialType::conductor) m.reflectance = {1e-4, 1e-4, 1e-4};
  options.reuse = {.automatic = false};
  const Film film = render(scene, options).film;
  CHECK_THAT(film.key, !Catch::Contains("light-paths"));
  options.caustics = Switch::off;
  CHECK((render(scene, options).film.image().pixels == film.image().pixels));
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

TEST_CASE("whether an image is reconstructed is chosen alike for all parts of it, and never for few tiles") {
  RenderOptions options;
  options.width = options.height = 192;
  options.spp = 1;
  const auto kept = [](const Scene& scene, const RenderOptions& o) {
    const Film film = render(scene, o).film;
    CHECK(film.differences().kept() == (film.key.find("; differences=on") != std::string::npos));
    return film.differences().kept();
  };
  const Scene box = standard_scene("cornell_box"), outdoors = standard_scene("kinds/sky_and_ground");
  CHECK(kept(box, options));
  CHECK_FALSE(kept(outdoors, options));
  options.crop = Window{.x0 = 20, .y0 = 30, .x1 = 33, .y1 = 41};
  options.samples = SampleRange{5, 1};
  options.threads = 3;
  options.seed = 9;
  CHECK(kept(box, options));
  CHECK_FALSE(kept(outdoors, options));
  options.target_error = 0.1;
  options.samples.reset();
  CHECK_FALSE(kept(box, options));
  RenderOptions small;
  small.width = small.height = 32;
  small.spp = 4;
  CHECK_FALSE(kept(box, small));
}

TEST_CASE("under leaves paths are plain by default, in the box they are shared, whatever part is rendered") {
  RenderOptions options;
  options.width = options.height = 64;
  options.spp = 2;
  const auto pixels = [](const Scene& scene, const RenderOptions& o) {
    return render(scene, o).film.image().pixels;
  };
  RenderOptions plain = options, shared = options;
  plain.reuse = {.automatic = false};
  shared.reuse = {.automatic = false, .width = 8, .height = 8, .suffixes = 64};
  const Scene leaves = standard_scene("kinds/foliage"), box = standard_scene("cornell_box");
  CHECK(pixels(leaves, options) == pixels(leaves, plain));
  CHECK(pixels(box, options) == pixels(box, shared));
  const RenderResult alone = render(leaves, options);
  CHECK_THAT(alone.film.key, Catch::EndsWith("sharing=off"));
  CHECK_THAT(render(box, options).film.key, Catch::Contains("sharing=on"));
  CHECK(alone.stats.pilot_seconds > 0);
  CHECK(alone.stats.render_seconds > alone.stats.pilot_seconds);
  CHECK(render(box, plain).stats.pilot_seconds == 0);  // there is nothing to choose
  for (RenderOptions* o : {&options, &plain}) {
    o->crop = Window{.x0 = 20, .y0 = 30, .x1 = 33, .y1 = 41};
    o->samples = SampleRange{5, 1};
    o->threads = 3;
  }
  CHECK(pixels(leaves, options) == pixels(leaves, plain));
}
