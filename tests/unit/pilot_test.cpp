#include "wavefront/pilot.h"

#include <catch2/catch.hpp>

#include <limits>

#include "castray/render.h"
#include "core/sequences.h"
#include "test_scenes.h"

using namespace castray;
using namespace castray::test;

namespace {

/// Uniform in [-1,1).
float noise(std::uint32_t seed, const TileJob& job, std::uint32_t pixel, std::uint32_t kind) {
  std::uint32_t h = hash_combine(seed, static_cast<std::uint32_t>(job.x));
  for (const std::uint32_t k :
       {static_cast<std::uint32_t>(job.y), static_cast<std::uint32_t>(job.sample), pixel, kind})
    h = hash_combine(h, k);
  return static_cast<float>(h >> 8) * 0x1p-23f - 1;
}

/// A renderer whose pixels are 1 + what is seen of emitters, and noise of the given greatest size.
RenderJob pretended(float shared_noise, float plain_noise, float emitted, std::uint64_t shared_rays,
                    std::uint64_t plain_rays, std::uint64_t gathered = 0, std::uint64_t evaluated = 0) {
  return [=](const KernelOptions& options, const TileJob& job, TileResult& result) {
    const bool seen_only = options.max_depth == 1, shared = options.suffixes > 0;
    for (std::uint32_t i = 0; i < tile_pixels; ++i)
      for (std::uint32_t c = 0; c < 3; ++c) {
        const float seen = emitted * (1 + noise(options.seed, job, i, 7));
        const float size = shared ? shared_noise : plain_noise;
        result.radiance[c][i] =
            seen + (seen_only ? 0 : 1 + size * noise(options.seed, job, i, shared ? c : 3 + c));
      }
    result.rays += shared ? shared_rays + gathered : plain_rays;
    result.gathered += shared ? gathered : 0;
    result.evaluated += shared ? evaluated : 0;
  };
}

KernelOptions sharing() {
  KernelOptions options{};
  options.suffixes = 64;
  options.ragged = 4;
  return options;
}

}  // namespace

TEST_CASE("the pilot's gain of sharing is the ratio of variances times that of costs") {
  // 32 tiles of 64 pixels with 3 channels and 2 degrees of freedom: a variance is known to 1.3 %
  for (const float ratio : {0.5f, 1.f, 2.f}) {
    const auto gain = gain_of_sharing(sharing(), 512, 512, 1, pretended(0.1f, 0.1f * ratio, 0, 2000, 500));
    REQUIRE(gain);
    CHECK(*gain == Approx(ratio * ratio * 500 / 2000).epsilon(0.08));
  }
}

TEST_CASE("to the pilot, what pixels gather costs less than rays, and BSDFs to evaluate cost something") {
  const auto gain = [](std::uint64_t rays, std::uint64_t gathered, std::uint64_t evaluated) {
    return *gain_of_sharing(sharing(), 256, 256, 1,
                            pretended(0.1f, 0.2f, 0, rays, 1000, gathered, evaluated));
  };
  CHECK(gain(1000, 4000, 0) < 0.75 * gain(1000, 0, 0));
  CHECK(gain(1000, 4000, 0) > 2 * gain(5000, 0, 0));
  CHECK(gain(1000, 4000, 4000) < 0.95 * gain(1000, 4000, 0));
}

TEST_CASE("what the camera sees of emitters does not count in the pilot, nor does what is not finite") {
  const RenderJob quiet = pretended(0.1f, 0.2f, 0, 1000, 1000), loud = pretended(0.1f, 0.2f, 100, 1000, 1000);
  const auto expected = gain_of_sharing(sharing(), 256, 256, 1, quiet);
  CHECK(*gain_of_sharing(sharing(), 256, 256, 1, loud) == Approx(*expected).epsilon(1e-3));
  const RenderJob broken = [&](const KernelOptions& options, const TileJob& job, TileResult& result) {
    quiet(options, job, result);
    if (job.sample == 2 && options.max_depth != 1)
      result.radiance[1][5] = std::numeric_limits<float>::infinity();
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

TEST_CASE(
    "between mirrors paths are plain by default, in the box they are shared, whatever part is rendered") {
  RenderOptions options;
  options.width = options.height = 64;
  options.spp = 2;
  const auto pixels = [](const Scene& scene, const RenderOptions& o) {
    return render(scene, o).film.image().pixels;
  };
  RenderOptions plain = options, shared = options;
  plain.reuse = {.automatic = false};
  shared.reuse = {.automatic = false, .width = 8, .height = 8, .suffixes = 64};
  const Scene mirrors = standard_scene("kinds/facing_mirrors"), box = standard_scene("cornell_box");
  CHECK(pixels(mirrors, options) == pixels(mirrors, plain));
  CHECK(pixels(box, options) == pixels(box, shared));
  const RenderResult alone = render(mirrors, options);
  CHECK_THAT(alone.film.key, Catch::EndsWith("sharing=off"));
  CHECK_THAT(render(box, options).film.key, Catch::EndsWith("sharing=on"));
  CHECK(alone.stats.pilot_seconds > 0);
  CHECK(alone.stats.render_seconds > alone.stats.pilot_seconds);
  CHECK(render(mirrors, plain).stats.pilot_seconds == 0);
  for (RenderOptions* o : {&options, &plain}) {
    o->crop = Window{.x0 = 20, .y0 = 30, .x1 = 33, .y1 = 41};
    o->samples = SampleRange{5, 1};
    o->threads = 3;
  }
  CHECK(pixels(mirrors, options) == pixels(mirrors, plain));
}
