#include <catch2/catch.hpp>

#include <cmath>

#include "integrators.h"
#include "statistics.h"
#include "test_scenes.h"

using namespace castray;
using namespace castray::test;

// No sampling makes rare bright samples: what a sample shows is the light itself, or much less.

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

/// The greatest component of any sample, without the emission that the camera sees; of `count` samples a
/// pixel.
double largest_sample(const Scene& scene, RenderOptions options, std::uint64_t count) {
  const double emission = brightest_emission(scene);
  double largest = 0;
  for (std::uint64_t i = 0; i < count; ++i) {
    options.samples = SampleRange{i, 1};
    const Image image = render(scene, options).film.image();
    for (const Vec3f& pixel : image.pixels) {
      const double value = max_component(pixel);
      largest = std::max(largest, value < 0.999 * emission ? value : value - emission);
    }
  }
  return largest;
}

void check_largest(std::uint64_t samples, std::uint64_t reference_samples) {
  for (const std::string& name : scenes)
    for (const Way& way : ways()) {
      CAPTURE(name, way.name);
      const Scene scene = standard_scene(name);
      const std::uint64_t count = way.name == "reference" ? reference_samples : samples;
      // The furnace's radiance is 2; a path that survives n roulettes there adds at most 1 a vertex.
      CHECK(largest_sample(scene, way.options, count) <
            (name == "furnace" ? 32 : 0.67 * brightest_emission(scene)));
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

TEST_CASE("no sample is brighter than the light it sees by two thirds of a light") { check_largest(64, 8); }

TEST_CASE("no sample is brighter than the light it sees by two thirds of a light, 4096 a pixel", "[long]") {
  check_largest(4096, 256);
}

TEST_CASE("pixels beyond six sigma of their neighbours get fewer with more samples") {
  const Scene scene = standard_scene("cornell_conductor");
  for (const Way& way : ways()) {
    CAPTURE(way.name);
    if (way.name == "reference") continue;
    RenderOptions options = way.options;
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
