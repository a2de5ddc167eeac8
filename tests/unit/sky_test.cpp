#include <catch2/catch.hpp>

#include <cmath>
#include <fstream>
#include <numbers>

#include "castray/scene.h"
#include "materials/environment_image.h"
#include "scene/sky.h"
#include "temporary_folder.h"

using namespace castray;

namespace {

const double pi = std::numbers::pi;

/// The integral of an image over all directions, of its luminance.
double total(const Image& image) {
  double sum = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      sum += luminance(Vec3d(image.at(x, y))) * 4 * pi * share_of_row(y, image.height) / image.width;
  return sum;
}

}  // namespace

TEST_CASE("a clear sky has the zenith's luminance, and is brightest at the sun") {
  const double t = 3, s = 50 * pi / 180;
  const Image image = sky_image({.turbidity = t, .sun_elevation = 40, .sun_azimuth = 90, .sun = false}, 256);
  const double zenith =
      (4.0453 * t - 4.9710) * std::tan((4.0 / 9 - t / 120) * (pi - 2 * s)) - 0.2155 * t + 2.4192;
  CHECK(luminance(Vec3d(image.at(0, 0))) == Approx(zenith).epsilon(0.02));
  int brightest = 0;
  for (int i = 0; i < 512 * 128; ++i)
    if (image.pixels[static_cast<std::size_t>(i)].y > image.pixels[static_cast<std::size_t>(brightest)].y)
      brightest = i;
  CHECK(std::abs(brightest % 512 - 128) <= 2);  // +x is a quarter from the left
  CHECK(std::abs(brightest / 512 - 256 * 50 / 180) <= 2);
  // As bright on both sides of the sun's azimuth, and blue opposite to it.
  for (const int row : {10, 60, 100}) CHECK(image.at(128 + 40, row).y == Approx(image.at(127 - 40, row).y));
  CHECK(image.at(384, 80).z > 1.5f * image.at(384, 80).x);
}

TEST_CASE("the sun brings its light, dimmed by the air, however its disc lies on the texels") {
  const double mass = 1 / (std::cos(50 * pi / 180) + 0.15 * std::pow(93.885 - 50, -1.253));
  for (const double turbidity : {2.0, 6.0}) {
    const double beta = 0.04608 * turbidity - 0.04586;
    const auto through = [&](double l) {
      return std::exp(-mass * (0.008735 * std::pow(l, -4.08) + beta * std::pow(l, -1.3)));
    };
    const double expected = 127.5 * luminance(Vec3d{through(0.615), through(0.545), through(0.465)});
    for (const double azimuth : {0.0, 33.3, 180.1}) {
      Sky sky{.turbidity = turbidity, .sun_elevation = 40, .sun_azimuth = azimuth, .ground = {}};
      const double with = total(sky_image(sky, 512));
      sky.sun = false;
      CAPTURE(turbidity, azimuth);
      CHECK(with - total(sky_image(sky, 512)) == Approx(expected).epsilon(1e-4));
    }
  }
}

TEST_CASE("the ground reflects the sky") {
  Image all = sky_image({.ground = Vec3d(1)}, 128), half = sky_image({.ground = Vec3d(0.5)}, 128);
  CHECK(half.at(7, 100).y == Approx(all.at(7, 100).y / 2));
  double irradiance = 0;
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 256; ++x)
      irradiance += static_cast<double>(all.at(x, y).y) * 4 * pi * share_of_row(y, 128) / 256 *
                    std::cos(pi * (y + 0.5) / 128);
  CHECK(all.at(7, 100).y == Approx(irradiance / pi));
}

TEST_CASE("scene files have skies and gradients") {
  const TemporaryFolder folder;
  std::ofstream(folder / "t.obj") << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  const auto environment = [&](const std::string& json) {
    std::ofstream(folder / "s.json") << R"({ "environment": )" << json
                                     << R"(, "meshes": [ { "obj": "t.obj" } ] })";
    return load_scene(folder / "s.json");
  };
  const Scene gradient =
      environment(R"({ "gradient": { "zenith": [0, 0, 1], "horizon": [1, 1, 1], "ground": 0.25 } })");
  CHECK(gradient.environment.z == Approx(0.5 + 0.125));                 // half of all directions lie below
  CHECK(gradient.environment.x == Approx(0.25 + 0.125).epsilon(1e-4));  // the mean sine is a half
  const Scene sky = environment(R"({ "sky": { "sun_elevation": 30 }, "rotation": 20 })");
  const Scene scaled = environment(R"({ "sky": { "sun_elevation": 30 }, "scale": 0.3 })");
  CHECK(sky.environment_image.rotation == 20);
  CHECK(scaled.environment.y == Approx(10 * sky.environment.y));
  CHECK(!sky.default_environment);
}
