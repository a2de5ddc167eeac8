#include "lights/environment.h"

#include <catch2/catch.hpp>

#include <numbers>
#include <random>

#include "materials/environment_image.h"
#include "materials/texture.h"
#include "statistics.h"
#include "test_scenes.h"

using namespace castray;
using namespace castray::test;

namespace {

Scene under(const Image& image, double rotation = 0, double scale = 1) {
  Scene scene;
  scene.textures.push_back(make_texture("sky", image));
  scene.environment_image = {0, scale, rotation};
  scene.environment = mean_environment(scene);
  return scene;
}

/// Of random values, a third of them black, one row all black, and one texel very bright.
Image patchy() {
  Image image(24, 12);
  std::minstd_rand random(3);
  std::uniform_real_distribution<float> any(0, 1);
  for (Vec3f& p : image.pixels)
    p = any(random) < 0.33f ? Vec3f() : Vec3f(any(random), any(random), any(random));
  for (int x = 0; x < 24; ++x) image.at(x, 7) = Vec3f();
  image.at(17, 3) = Vec3f(80);
  return image;
}

}  // namespace

TEST_CASE("an environment's samples have the pdf and the radiance of their directions") {
  const Scene scene = under(patchy(), 123, 2);
  const Environment environment(scene);
  REQUIRE(environment.is_sampled());
  std::mt19937 random(1);
  std::uniform_real_distribution<double> any(0, 1);
  for (int i = 0; i < 10000; ++i) {
    const EnvironmentSample<double> s = environment.sample(Point2<double>{any(random), any(random)});
    REQUIRE(length(s.w) == Approx(1));
    REQUIRE(s.pdf > 0);
    REQUIRE(environment.pdf(s.w) == Approx(s.pdf));
    REQUIRE(environment.radiance(s.w) == s.radiance);
    REQUIRE(luminance(s.radiance) > 0);
  }
}

// Cells of equal solid angle, 12 x 24; false alarm: 1e-4.
TEST_CASE("an environment's samples are distributed as their pdf says", "[statistical]") {
  const Environment environment(under(patchy(), 50));
  constexpr int rows = 12, columns = 24, samples = 200000, steps = 64;
  const auto cell = [](const Vec3d& w) {
    const double turn = std::atan2(w.x, w.z) / (2 * std::numbers::pi) + 0.5;
    return std::min(static_cast<int>((w.y + 1) / 2 * rows), rows - 1) * columns +
           std::min(static_cast<int>(turn * columns), columns - 1);
  };
  std::vector<double> counts(rows * columns), expected(rows * columns);
  std::mt19937 random(2);
  std::uniform_real_distribution<double> any(0, 1);
  for (int i = 0; i < samples; ++i)
    ++counts[static_cast<std::size_t>(cell(environment.sample(Point2<double>{any(random), any(random)}).w))];
  double total = 0;
  constexpr int fine_rows = rows * steps * 4, fine_columns = columns * steps;
  for (int i = 0; i < fine_rows; ++i)
    for (int j = 0; j < fine_columns; ++j) {
      const double y = 2 * (i + 0.5) / fine_rows - 1;
      const double phi = 2 * std::numbers::pi * ((j + 0.5) / fine_columns - 0.5),
                   across = std::sqrt(1 - y * y);
      const Vec3d w{across * std::sin(phi), y, across * std::cos(phi)};
      const double share = environment.pdf(w) * 4 * std::numbers::pi / (fine_rows * fine_columns);
      expected[static_cast<std::size_t>(cell(w))] += share * samples;
      total += share;
    }
  CHECK(total == Approx(1).epsilon(2e-3));
  // the midpoint rule leaves 1 % of what straddles a texel's edge
  double statistic = 0;
  int cells = 0;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const double variance = expected[i] + std::pow(0.01 * expected[i], 2) + 5;
    statistic += std::pow(counts[i] - expected[i], 2) / variance;
    ++cells;
  }
  CHECK(chi_square_tail(statistic, cells) > 1e-4);
}

TEST_CASE("the mean of an environment image weighs rows by their solid angle") {
  Image image(2, 2);
  image.pixels = {Vec3f(1), Vec3f(2), Vec3f(4), Vec3f(8)};
  CHECK(under(image).environment.x == Approx(15. / 4));
  Image bands(1, 3);
  bands.pixels = {Vec3f(1), Vec3f(0), Vec3f(0)};  // down to 60 degrees: a quarter of the sphere
  CHECK(under(bands, 0, 6).environment.y == Approx(6 * 0.25));
}

TEST_CASE("a black environment image is none") {
  const Scene scene = under(Image(4, 2));
  CHECK_FALSE(Environment(scene).is_sampled());
  CHECK_FALSE(Environment(scene).table().shines);
}
