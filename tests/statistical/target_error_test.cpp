#include <catch2/catch.hpp>

#include <cmath>

#include "reference_images.h"
#include "test_scenes.h"

using namespace castray;
using namespace castray::test;

// --target-error: what it promises and what it reaches.

namespace {

RenderOptions to_target(RenderOptions options, double target) {
  options.target_error = target;
  options.spp = most_samples_to_target;
  return options;
}

Image image_of(const Scene& scene, const RenderOptions& options) {
  return castray::image_of(render(scene, options).film);
}

std::vector<std::vector<double>> renders_of(const Scene& scene, RenderOptions options, std::uint64_t seeds) {
  std::vector<std::vector<double>> renders;
  for (std::uint64_t i = 0; i < seeds; ++i, ++options.seed)
    renders.push_back(block_means(image_of(scene, options), 8));
  return renders;
}

void check_mean(const char* name, const std::vector<std::vector<double>>& renders,
                const ExpectedBlocks& expected) {
  const BlockScores scores = block_scores(renders, expected.mean, expected.variance);
  CAPTURE(name, scores.rms, scores.largest, scores.count);
  CHECK(scores.largest < score_limit(scores.count, 1e-4));  // the rate of false alarms
  CHECK(scores.rms < 1.25);                                 // 192 scores: 1 has a standard error of 0.05
}

}  // namespace

// The error told is an estimate of two half films, and of those pixels only that differ much.
TEST_CASE("the error that a target asks for is about the error that is got, and the error told is",
          "[statistical]") {
  struct Case {
    const char* scene;
    bool shared;
    double target;
  };
  for (const Case& c : {Case{"cornell_box", true, 1e-3}, Case{"cornell_box", false, 1e-2},
                        Case{"cornell_conductor", true, 2e-3}, Case{"cornell_conductor", false, 3e-2},
                        Case{"cornell_lights", true, 5e-3}}) {
    const Scene scene = standard_scene(c.scene);
    const ReferencePair reference(c.scene);
    Mean got, told;
    for (std::uint64_t seed = 0; seed < 4; ++seed) {
      const RenderOptions options = to_target(wavefront_options(128, 1, seed), c.target);
      const RenderResult result = render(scene, c.shared ? options : plain(options));
      told.add(result.stats.expected_error.value());
      got.add(reference.relmse(castray::image_of(result.film)));
    }
    CAPTURE(c.scene, c.shared, c.target, got.mean(), told.mean());
    CHECK(got.mean() > c.target * 0.5);
    CHECK(got.mean() < c.target * 1.5);
    CHECK(got.mean() == Approx(told.mean()).epsilon(0.2));
  }
}

// Plain paths on metal are where samples that look at themselves would lose light: rare bright samples.
TEST_CASE("a render to a target error has the mean of a plain one, reconstructed or not", "[statistical]") {
  for (const char* name : {"cornell_conductor", "cornell_box"}) {
    const Scene scene = standard_scene(name);
    const ExpectedBlocks expected(renders_of(scene, wavefront_options(64, 64, 5000), 32));
    check_mean(name, renders_of(scene, to_target(plain(wavefront_options(64, 1, 1)), 0.1), 200), expected);
    RenderOptions reconstructed = to_target(wavefront_options(64, 1, 1), 5e-4);
    reconstructed.reconstruct = Switch::on;
    check_mean(name, renders_of(scene, reconstructed, 20), expected);
  }
}
