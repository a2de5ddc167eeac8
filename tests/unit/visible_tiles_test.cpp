#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>

#include "castray/render.h"
#include "test_scenes.h"

using namespace castray;
using namespace castray::test;

namespace {

Image image(const Scene& scene, std::uint64_t spp, std::uint64_t seed) {
  RenderOptions options;
  options.width = options.height = 64;
  options.spp = spp;
  options.seed = seed;
  options.reconstruct = Switch::on;
  return image_of(render(scene, options).film);
}

/// The mean steps of an image's error between neighbours in a row, or else in a column, by the place of the
/// first of them in a grid of 8 pixels; relative to the brightness, and where the true image is smooth.
std::array<double, 8> steps_of_error(const Image& image, const Image& truth, bool in_row) {
  std::array<double, 8> sums = {}, counts = {};
  for (int y = 0; y + 1 < image.height; ++y)
    for (int x = 0; x + 1 < image.width; ++x) {
      const auto step = [&](const Image& of) {
        return luminance(Vec3d(of.at(in_row ? x + 1 : x, in_row ? y : y + 1)) - Vec3d(of.at(x, y)));
      };
      const double brightness = luminance(Vec3d(truth.at(x, y))), true_step = step(truth);
      if (std::abs(true_step) > 0.05 * brightness) continue;
      const auto place = static_cast<std::size_t>((in_row ? x : y) % 8);
      sums[place] += std::abs(step(image) - true_step) / (brightness + 0.01);
      ++counts[place];
    }
  for (std::size_t i = 0; i < 8; ++i) sums[i] /= counts[i];
  return sums;
}

/// How much greater the steps of the error are at the place in the grid where they are greatest, over those
/// at the usual place: 1 where no grid is to be seen. A single grid of tiles lies where it likes.
double visibility_of_tiles(const Image& image, const Image& truth) {
  double greatest = 0;
  for (const bool in_row : {true, false}) {
    std::array<double, 8> steps = steps_of_error(image, truth, in_row);
    std::sort(steps.begin(), steps.end());
    greatest = std::max(greatest, steps[7] / ((steps[3] + steps[4]) / 2));
  }
  return greatest;
}

}  // namespace

TEST_CASE("the tiles of shared paths are not to be seen in reconstructed images of few samples") {
  for (const char* name : {"cornell_box", "kinds/cove"}) {
    const Scene scene = standard_scene(name);
    const Image truth = image(scene, 64, 77);
    for (const std::uint64_t spp : {1u, 2u, 4u, 16u}) {
      CAPTURE(name, spp);
      CHECK(visibility_of_tiles(image(scene, spp, 5), truth) < 2.2);
    }
  }
}
