#include <catch2/catch.hpp>

#include <cmath>

#include "integrators.h"
#include "reference/estimator.h"
#include "statistics.h"
#include "test_scenes.h"

using namespace castray;
using namespace castray::test;

// No sampling makes rare bright samples: what a sample shows is the light itself, or much less. Each of the
// techniques that meet a light brings at most its emission times the path's throughput, which roulette lets
// grow to 1 / highest_survival. Two bright meetings in one path are very rare; more have not been seen.

namespace {

/// Scenes without mirrors.
const std::vector<std::string> scenes = {"cornell_box",        "cornell_conductor", "cornell_lights",
                                         "cornell_microfacet", "cornell_obj",       "furnace"};

constexpr int side = 64;

/// The default, plain paths, and the reference.
std::vector<Way> ways() {
  RenderOptions shared;
  shared.width = shared.height = side;
  RenderOptions plain = shared, reference = shared;
  plain.reuse = {.automatic = false};
  reference.integrator = Integrator::reference;
  return {{"shared", shared}, {"plain", plain}, {"reference", reference}};
}

double brightest_emission(const Scene& scene) {
  double brightest = 0;
  for (const Material& material : scene.materials)
    brightest = std::max(brightest, max_component(material.ke));
  return brightest;
}

struct BrightSamples {
  double largest = 0;  ///< the greatest component of any sample
  double share = 0;    ///< of the samples that are above a bound
};

/// Of `count` samples a pixel, without the emission that the camera sees.
BrightSamples bright_samples(const Scene& scene, RenderOptions options, std::uint64_t count, double bound) {
  RenderOptions seen_by_camera = options;
  seen_by_camera.max_depth = 1;
  BrightSamples bright;
  for (std::uint64_t i = 0; i < count; ++i) {
    options.samples = seen_by_camera.samples = SampleRange{i, 1};
    const Image image = render(scene, options).film.image();
    const Image seen = render(scene, seen_by_camera).film.image();
    for (std::size_t p = 0; p < image.pixels.size(); ++p) {
      const double value = max_component(image.pixels[p] - seen.pixels[p]);
      bright.largest = std::max(bright.largest, value);
      bright.share += value > bound;
    }
  }
  bright.share /= static_cast<double>(count) * side * side;
  return bright;
}

/// At most a `share` of the samples is above two thirds of the brightest light, and none above what one
/// meeting with it brings, or two where paths are not shared and metal reflects the light. The furnace's
/// radiance is 2; a path that survives n roulettes there adds at most 1 a vertex.
void check_largest(std::uint64_t samples, std::uint64_t reference_samples, double share) {
  for (const std::string& name : scenes)
    for (const Way& way : ways()) {
      CAPTURE(name, way.name);
      const Scene scene = standard_scene(name);
      const bool furnace = name == "furnace";
      const double light = brightest_emission(scene), bound = furnace ? 31 : light * 2 / 3;
      const std::uint64_t count = way.name == "reference" ? reference_samples : samples;
      const BrightSamples bright = bright_samples(scene, way.options, count, bound);
      const int meetings = name == "cornell_conductor" && way.name != "shared" ? 2 : 1;
      CHECK(bright.largest < (furnace ? 31 : meetings * light / highest_survival));
      CHECK(bright.share <= share);
    }
}

/// Pixels whose difference from the converged image is beyond six standard deviations of their neighbours';
/// where the light is near, pixels do not have the variance of their neighbours, and are left out.
int outliers(const Image& image, const Image& converged, float light) {
  const auto error = [&](int x, int y) {
    return static_cast<double>(luminance(image.at(x, y)) - luminance(converged.at(x, y)));
  };
  int count = 0;
  for (int y = 2; y < side - 2; ++y)
    for (int x = 2; x < side - 2; ++x) {
      Mean around;
      float brightest = 0;
      for (int j = y - 2; j <= y + 2; ++j)
        for (int i = x - 2; i <= x + 2; ++i) {
          brightest = std::max(brightest, max_component(converged.at(i, j)));
          if (i != x || j != y) around.add(error(i, j));
        }
      if (brightest > light / 8) continue;
      count += std::abs(error(x, y) - around.mean()) > 6 * std::sqrt(around.variance());
    }
  return count;
}

}  // namespace

TEST_CASE("no sample is brighter than the light it sees by two thirds of a light") {
  check_largest(64, 8, 0);
}

TEST_CASE("of 4096 samples a pixel few are brighter by two thirds of a light, none by more than two",
          "[long]") {
  check_largest(4096, 256, 5e-6);
}

TEST_CASE("pixels beyond six sigma of their neighbours get fewer with more samples") {
  const Scene scene = standard_scene("cornell_conductor");
  for (const Way& way : ways()) {
    CAPTURE(way.name);
    if (way.name == "reference") continue;
    RenderOptions options = way.options;
    options.reconstruct =
        Switch::off;  // which leaves the noise of neighbours much smaller than that of edges
    options.spp = 1024;
    options.seed = 99;
    const Image converged = render(scene, options).film.image();
    std::vector<int> counts;
    for (const std::uint64_t spp : {1, 8, 64}) {
      options.spp = spp;
      int count = 0;
      for (options.seed = 1; options.seed <= 8; ++options.seed)
        count += outliers(render(scene, options).film.image(), converged,
                          static_cast<float>(brightest_emission(scene)));
      counts.push_back(count);
    }
    CAPTURE(counts);
    CHECK(counts.front() > 2 * counts.back());
  }
}
