// Images on materials as Mitsuba shows them: tests/golden/details, made by tests/oracles/details.py.
#include <catch2/catch.hpp>

#include "integrators.h"
#include "render_blocks.h"
#include "test_scenes.h"

using namespace castray;
using namespace castray::test;

namespace {

const std::string folder = std::string(CASTRAY_ROOT) + "/tests/golden/details/";

/// A stored image, a pixel for each block.
std::vector<double> stored(const std::string& name) {
  return block_means(read_image(folder + name).image, 1);
}

struct Expected {
  std::vector<double> mean, variance;
  explicit Expected(const std::string& scene)
      : mean(stored(scene + "_mean.pfm")), variance(stored(scene + "_variance.pfm")) {}
};

}  // namespace

// 5 scenes, 18 ways: 90 tests at a false-alarm rate of 1e-5 each.
TEST_CASE(
    "textures, holes, normal and bump maps and metal are as Mitsuba shows them, by every way of rendering",
    "[statistical]") {
  for (const std::string name : {"colours", "holes", "normals", "heights", "metal"}) {
    const Scene scene = load_scene(folder + name + ".json");
    const Expected expected(name);
    for (Way way : every_way(wavefront_options(scene.width, 8, 1))) {
      // shared whatever the pilot would say of these scenes
      if (way.options.reuse.automatic && way.options.integrator == Integrator::wavefront)
        way.options.reuse = {.automatic = false, .width = 8, .height = 8, .suffixes = 64};
      const BlockScores scores =
          block_scores(blocks_of(scene, way.options, 12), expected.mean, expected.variance);
      CAPTURE(name, way.name, scores.largest, scores.rms, scores.count);
      CHECK(scores.count > 300);
      CHECK(scores.largest < score_limit(scores.count, 1e-5));
      CHECK(scores.rms < 1.2);  // of some 600 scores: 1 with a standard error of 0.03
    }
  }
}
