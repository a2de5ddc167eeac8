// Images by Mitsuba: materials in tests/golden/details, cameras in tests/golden/cameras, made by scripts of
// these names in tests/oracles.
#include <catch2/catch.hpp>

#include "integrators.h"
#include "render_blocks.h"
#include "test_scenes.h"

using namespace castray;
using namespace castray::test;

namespace {

/// A stored image, a pixel for each block.
std::vector<double> stored(const std::string& name) { return block_means(read_image(name).image, 1); }

/// By every way of rendering: 18 tests a scene, at a false-alarm rate of 1e-5 each.
void check_against_mitsuba(const std::string& folder, const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    const std::string file = std::string(CASTRAY_ROOT) + "/tests/golden/" + folder + "/" + name;
    const Scene scene = load_scene(file + ".json");
    const std::vector<double> mean = stored(file + "_mean.pfm"), variance = stored(file + "_variance.pfm");
    for (Way way : every_way(wavefront_options(scene.width, 8, 1))) {
      // shared whatever the pilot would say of these scenes
      if (way.options.reuse.automatic && way.options.integrator == Integrator::wavefront)
        way.options.reuse = {.automatic = false, .width = 8, .height = 8, .suffixes = 64};
      const BlockScores scores = block_scores(blocks_of(scene, way.options, 12), mean, variance);
      CAPTURE(name, way.name, scores.largest, scores.rms, scores.count);
      CHECK(scores.count > 300);
      CHECK(scores.largest < score_limit(scores.count, 1e-5));
      CHECK(scores.rms < 1.2);  // of some 600 scores: 1 with a standard error of 0.03
    }
  }
}

}  // namespace

TEST_CASE(
    "textures, holes, normal and bump maps and metal are as Mitsuba shows them, by every way of rendering",
    "[statistical]") {
  check_against_mitsuba("details", {"colours", "holes", "normals", "heights", "metal"});
}

TEST_CASE("a lens, parallel rays and a shift are as Mitsuba shows them, by every way of rendering",
          "[statistical]") {
  check_against_mitsuba("cameras", {"lens", "orthographic", "shift"});
}
