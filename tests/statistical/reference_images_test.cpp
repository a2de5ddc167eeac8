#include <catch2/catch.hpp>

#include <fmt/core.h>

#include "reference_images.h"
#include "test_scenes.h"

using namespace castray;
using namespace castray::test;

// castRay against images by an independent renderer, measured free of their noise.

namespace {

constexpr int side = 128, block = 8;
const std::vector<std::string> scenes = {"cornell_box", "cornell_conductor", "cornell_lights"};

/// A standard scene with the masking of the renderer of the images, whose conductors lose a little energy:
/// the conductor's blocks differ by 0.1 % of the mean else, which many samples show.
Scene scene_of_images(const std::string& name) {
  Scene scene = standard_scene(name);
  for (Material& m : scene.materials) m.correlated_masking = false;
  return scene;
}

Image rendered(const Scene& scene, std::uint64_t spp, std::uint64_t seed) {
  const RenderResult result = render(scene, reference_options(side, side, spp, seed));
  REQUIRE(result.film.nonfinite_samples == 0);
  return result.film.image();
}

/// Every block's mean over several seeds agrees with the reference, at a false-alarm rate of 1e-3 a scene.
void check_blocks(const std::string& name, std::uint64_t spp, std::uint64_t seeds) {
  const Scene scene = scene_of_images(name);
  const ReferencePair reference(name);
  std::vector<std::vector<double>> renders;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed)
    renders.push_back(block_means(rendered(scene, spp, seed), block));

  Image mean(side, side), variance(side, side);  // of (A+B)/2: that of (A-B)/2, as both halves are alike
  for (std::size_t i = 0; i < mean.pixels.size(); ++i) {
    mean.pixels[i] = Vec3f(reference.mean(i));
    const Vec3f half = (reference.a.pixels[i] - reference.b.pixels[i]) * 0.5f;
    variance.pixels[i] = half * half;
  }
  std::vector<double> block_variance = block_means(variance, block);
  for (double& v : block_variance) v /= block * block;
  const BlockScores scores = block_scores(renders, block_means(mean, block), block_variance);
  CAPTURE(name, scores.rms, scores.count);
  CHECK(scores.largest < score_limit(scores.count, 1e-3));
  CHECK(scores.rms < 1.15);  // 768 scores: 1 has a standard error of 0.026
}

/// spp * relMSE is the variance of one sample, whatever the spp: no floor, no bias. Each spp gets
/// `seeds_at_most` seeds, less at high spp; all pairs agree at 4.5 standard errors.
void check_convergence(const std::string& name, const std::vector<std::uint64_t>& spps,
                       std::uint64_t samples) {
  const Scene scene = scene_of_images(name);
  const ReferencePair reference(name);
  std::vector<Mean> variances;
  for (const std::uint64_t spp : spps) {
    Mean variance;
    const std::uint64_t seeds = std::max<std::uint64_t>(4, samples / spp);
    for (std::uint64_t seed = 1; seed <= seeds; ++seed)
      variance.add(static_cast<double>(spp) * reference.relmse(rendered(scene, spp, seed)));
    UNSCOPED_INFO(fmt::format("{} spp {}: spp * relMSE = {:.4f} +- {:.4f}", name, spp, variance.mean(),
                              variance.error()));
    variances.push_back(variance);
  }
  for (std::size_t i = 0; i + 1 < variances.size(); ++i) {
    const Mean &low = variances[i], &high = variances.back();
    CHECK(std::abs(low.mean() - high.mean()) < 4.5 * std::hypot(low.error(), high.error()));
  }
}

}  // namespace

TEST_CASE("castRay agrees with independent images in every 8x8 block", "[statistical]") {
  for (const std::string& name : scenes) check_blocks(name, 4, 16);
}

TEST_CASE("castRay agrees with independent images in every 8x8 block, many samples", "[statistical][long]") {
  for (const std::string& name : scenes) check_blocks(name, 64, 32);
}

TEST_CASE("castRay's relMSE falls as 1/spp", "[statistical]") {
  for (const std::string& name : scenes) check_convergence(name, {1, 4, 16}, 16);
}

TEST_CASE("castRay's relMSE falls as 1/spp up to 1024, without a floor", "[statistical][long]") {
  for (const std::string& name : scenes) check_convergence(name, {1, 4, 16, 64, 256, 1024}, 256);
}
