// Images by Mitsuba: materials in tests/golden/details, lights and instances in tests/golden/lights, cameras
// in tests/golden/cameras, made by scripts of these names in tests/oracles.
#include <catch2/catch.hpp>

#include "integrators.h"
#include "render_blocks.h"
#include "same_bytes.h"
#include "test_scenes.h"

using namespace castray;
using namespace castray::test;

namespace {

/// A stored image, a pixel for each block.
std::vector<double> stored(const std::string& name) { return block_means(read_image(name).image, 1); }

/// As the folder's files NAME_mean.pfm and NAME_variance.pfm show it.
struct Expected {
  std::vector<double> mean, variance;
  explicit Expected(const std::string& file)
      : mean(stored(file + "_mean.pfm")), variance(stored(file + "_variance.pfm")) {}
};

/// Has a false-alarm rate of 1e-5.
void check(const std::string& file, const Expected& expected, Way way) {
  const Scene scene = load_scene(file);
  way.options.width = scene.width, way.options.height = scene.height;
  // shared whatever the pilot would say of these scenes
  if (way.options.reuse.automatic && way.options.integrator == Integrator::wavefront)
    way.options.reuse = {.automatic = false, .width = 8, .height = 8, .suffixes = 64};
  const BlockScores scores =
      block_scores(blocks_of(scene, way.options, 12), expected.mean, expected.variance);
  CAPTURE(file, way.name, scores.largest, scores.rms, scores.count);
  CHECK(scores.count > 300);
  CHECK(scores.largest < score_limit(scores.count, 1e-5));
  CHECK(scores.rms < 1.2);  // of some 600 scores: 1 with a standard error of 0.03
}

const std::string golden = std::string(CASTRAY_ROOT) + "/tests/golden/";
const std::vector<std::string> details{"colours", "holes", "normals", "heights", "metal", "mirror"},
    without_mtl{"index", "glass", "pane", "pair", "brushed", "layers_brushed", "layers_brushed_image"},
    lights{"environment", "point", "spot", "directional", "emission", "instances"};

/// By every way of rendering: 10 tests a scene, and that the other instruction sets give the same bytes.
void check_against_mitsuba(const std::string& folder, const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    const std::string file = golden + folder + name;
    const Expected expected(file);
    check_same_bytes(load_scene(file + ".json"), wavefront_options(64, 2, 1));
    for (const Way& way : every_way(wavefront_options(64, 4, 1), arithmetics()))
      check(file + ".json", expected, way);
  }
}

/// By one kernel, with plain and with shared paths.
void check_both_paths(const std::string& file, const Expected& expected) {
  check(file, expected, {"plain", plain(wavefront_options(64, 8, 2))});
  check(file, expected, {"shared", wavefront_options(64, 8, 3)});
}

}  // namespace

TEST_CASE("images on materials are as Mitsuba shows them, by every way of rendering", "[statistical]") {
  check_against_mitsuba("details/", details);
}

TEST_CASE(
    "metal by its index, brushed metal, glass that absorbs, panes and pairs of materials are as Mitsuba "
    "shows them",
    "[statistical]") {
  for (const std::string& name : without_mtl) {
    const std::string file = golden + "details/" + name;
    check_both_paths(file + ".json", Expected(file));
  }
}

TEST_CASE(
    "an image of the sky, lights without size, a lamp with an image and instances are as Mitsuba shows them",
    "[statistical]") {
  for (const std::string& name : lights) {
    const std::string file = golden + "lights/" + name;
    const Expected expected(file);
    check_both_paths(file + ".json", expected);
    check(file + ".json", expected, {"reference", reference_options(64, 64, 8, 4)});
  }
}

TEST_CASE("MTL's images on materials are as Mitsuba shows them", "[statistical]") {
  for (const std::string& name : details) {
    const std::string file = golden + "details/" + name;
    check_both_paths(file + "_mtl.json", Expected(file));
  }
}

TEST_CASE("a lens, parallel rays and a shift are as Mitsuba shows them, by every way of rendering",
          "[statistical]") {
  check_against_mitsuba("cameras/", {"lens", "orthographic", "shift"});
}
