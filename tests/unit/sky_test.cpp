#include <catch2/catch.hpp>

#include <cmath>
#include <fstream>
#include <numbers>

#include "castray/scene.h"
#include "materials/environment_image.h"
#include "scene/sky.h"
#include "scene/sun_position.h"
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

TEST_CASE("the sun stands where almanacs say") {
  // Reda and Andreas 2008, NREL/TP-560-34302, appendix A.5: zenith angle 50.11162 with 0.0163 of refraction.
  const double golden = days_of("2003-10-17T12:30:30-07:00").value();
  const SunPosition sun = sun_position(golden, 39.742476, -105.1786);
  CHECK(sun.elevation == Approx(39.872046).margin(0.01));
  CHECK(sun.azimuth == Approx(194.34024).margin(0.015));
  // Meeus, Astronomical Algorithms, example 25.a: declination -7.78507; from the poles it is the elevation.
  const double october = days_of("1992-10-13T00:00Z").value();
  CHECK(sun_position(october, 90, 0).elevation == Approx(-7.78507).margin(0.01));
  CHECK(sun_position(october, -90, 33).elevation == Approx(7.78507).margin(0.01));
  // The June solstice of 2024, 20:51 UTC; the equinox of March, 03:06 UTC.
  CHECK(sun_position(*days_of("2024-06-20T20:51:00Z"), 90, 0).elevation == Approx(23.436).margin(0.01));
  CHECK(sun_position(*days_of("2024-03-20T03:06:00Z"), 90, 0).elevation == Approx(0).margin(0.01));
  // In the north at noon it is in the south, in the morning in the east, in the evening in the west.
  CHECK(sun_position(*days_of("2024-06-21T12:02Z"), 51.48, 0).azimuth == Approx(180).margin(0.5));
  CHECK(sun_position(*days_of("2024-06-21T06:00Z"), 51.48, 0).azimuth < 90);
  CHECK(sun_position(*days_of("2024-06-21T18:00Z"), 51.48, 0).azimuth > 270);
  CHECK(refraction(0) == Approx(0.48).margin(0.02));
  CHECK(refraction(45) == Approx(1. / 60).margin(0.002));
}

TEST_CASE("times are those of ISO 8601") {
  CHECK(days_of("2000-01-01T12:00Z") == 0);
  CHECK(days_of("2000-01-02T14:00:00+02:00") == 1);
  CHECK(days_of("1999-12-31T12:00:00Z") == -1);
  for (const char* wrong : {"2000-01-01", "2000-13-01T00:00Z", "2023-02-29T00:00Z", "2000-01-01T12:00",
                            "2000-01-01T12:60Z", "1850-01-01T12:00Z", "2000-01-01 12:00Z", ""}) {
    CAPTURE(wrong);
    CHECK_FALSE(days_of(wrong).has_value());
  }
}
