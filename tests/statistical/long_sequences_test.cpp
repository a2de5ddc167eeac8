#include <catch2/catch.hpp>

#include "castray/render.h"
#include "statistics.h"
#include "test_scenes.h"

using namespace castray;
using namespace castray::test;

// A tile takes 64 points of its sequence in each sample, so that its 2^20 points are used up after 2^14
// samples. The next ones are of another scramble: errors of samples that far apart must not be alike.

namespace {

/// Errors of one sample. In the furnace they are of suffixes alone; its radiance is 2.
Image errors_of_sample(const Scene& scene, std::uint64_t sample) {
  RenderOptions options;
  options.width = options.height = 32;
  options.samples = SampleRange{sample, 1};
  options.reuse = {.automatic = false, .suffixes = 64};
  options.reconstruct = Switch::off;
  Image image = render(scene, options).film.image();
  for (Vec3f& p : image.pixels) p = p - Vec3f(2);
  return image;
}

double mean_product(const Image& a, const Image& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i)
    sum += static_cast<double>(a.pixels[i].y) * static_cast<double>(b.pixels[i].y);
  return sum / static_cast<double>(a.pixels.size());
}

}  // namespace

TEST_CASE("samples far apart share no points of a tile's sequence", "[statistical]") {
  const Scene scene = standard_scene("furnace");
  constexpr std::uint64_t apart = 1u << 14;
  Mean alike, own;
  for (std::uint64_t sample = 0; sample < 200; ++sample) {
    const Image one = errors_of_sample(scene, sample), other = errors_of_sample(scene, sample + apart);
    alike.add(mean_product(one, other));
    own.add((mean_product(one, one) + mean_product(other, other)) / 2);
  }
  CAPTURE(alike.mean() / own.mean(), alike.error() / own.mean());
  CHECK(own.mean() > 0);
  CHECK(std::abs(alike.mean()) < 3.5 * alike.error());  // false alarms: 5e-4
}
