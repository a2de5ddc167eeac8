#include "scene/sky.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "materials/environment_image.h"

namespace castray {

namespace {

constexpr double pi = std::numbers::pi;
constexpr double sun_radius = 0.2665 * pi / 180;
const double sun_solid_angle = 2 * pi * (1 - std::cos(sun_radius));
constexpr double illuminance_outside = 127.5;  // klx, of a surface that faces the sun

/// Perez' formula for the luminance or a chromaticity of a clear sky, over that of the zenith.
struct Perez {
  double a, b, c, d, e;

  /// `cosine` of the angle to the zenith, > 0; `gamma`: angle to the sun.
  double operator()(double cosine, double gamma) const {
    const double cos_gamma = std::cos(gamma);
    return (1 + a * std::exp(b / cosine)) * (1 + c * std::exp(d * gamma) + e * cos_gamma * cos_gamma);
  }
};

/// A value of the sky: the zenith's times Perez' formula, over that formula at the zenith.
struct Distribution {
  Perez perez;
  double zenith, at_zenith;

  Distribution(const Perez& p, double value, double sun_angle)
      : perez(p), zenith(value), at_zenith(p(1, sun_angle)) {}
  double operator()(double cosine, double gamma) const { return zenith * perez(cosine, gamma) / at_zenith; }
};

/// (t^2, t, 1) times a matrix times (s^3, s^2, s, 1).
double chromaticity(const double (&m)[3][4], double t, double s) {
  const auto row = [s](const double(&r)[4]) { return ((r[0] * s + r[1]) * s + r[2]) * s + r[3]; };
  return (row(m[0]) * t + row(m[1])) * t + row(m[2]);
}

Vec3d linear_rgb(double x, double y, double luminance) {
  const double big_x = x / y * luminance, big_z = (1 - x - y) / y * luminance;
  const Vec3d rgb{3.2404542 * big_x - 1.5371385 * luminance - 0.4985314 * big_z,
                  -0.9692660 * big_x + 1.8760108 * luminance + 0.0415560 * big_z,
                  0.0556434 * big_x - 0.2040259 * luminance + 1.0572252 * big_z};
  return {std::max(rgb.x, 0.0), std::max(rgb.y, 0.0), std::max(rgb.z, 0.0)};
}

/// Preetham, Shirley and Smits, appendix A.2; `s`: angle from the zenith to the sun.
class ClearSky {
 public:
  ClearSky(double t, double s)
      : luminance_({0.1787 * t - 1.4630, -0.3554 * t + 0.4275, -0.0227 * t + 5.3251, 0.1206 * t - 2.5771,
                    -0.0670 * t + 0.3703},
                   zenith_luminance(t, s), s),
        x_({-0.0193 * t - 0.2592, -0.0665 * t + 0.0008, -0.0004 * t + 0.2125, -0.0641 * t - 0.8989,
            -0.0033 * t + 0.0452},
           chromaticity({{0.00166, -0.00375, 0.00209, 0},
                         {-0.02903, 0.06377, -0.03202, 0.00394},
                         {0.11693, -0.21196, 0.06052, 0.25886}},
                        t, s),
           s),
        y_({-0.0167 * t - 0.2608, -0.0950 * t + 0.0092, -0.0079 * t + 0.2102, -0.0441 * t - 1.6537,
            -0.0109 * t + 0.0529},
           chromaticity({{0.00275, -0.00610, 0.00317, 0},
                         {-0.04214, 0.08970, -0.04153, 0.00516},
                         {0.15346, -0.26756, 0.06670, 0.26688}},
                        t, s),
           s) {}

  Vec3d radiance(double cosine, double gamma) const {
    const double above_horizon = std::max(cosine, 1e-3);
    return linear_rgb(x_(above_horizon, gamma), y_(above_horizon, gamma),
                      std::max(luminance_(above_horizon, gamma), 0.0));
  }

 private:
  static double zenith_luminance(double t, double s) {
    const double chi = (4.0 / 9 - t / 120) * (pi - 2 * s);
    return (4.0453 * t - 4.9710) * std::tan(chi) - 0.2155 * t + 2.4192;
  }

  Distribution luminance_, x_, y_;
};

/// Of the sun's light through the air, for red, green and blue; `s`: angle from the zenith to the sun.
Vec3d transmittance(double turbidity, double s) {
  const double mass = 1 / (std::cos(s) + 0.15 * std::pow(93.885 - s * 180 / pi, -1.253));
  const double beta = 0.04608 * turbidity - 0.04586;
  const auto at = [&](double micrometres) {
    return std::exp(-mass * (0.008735 * std::pow(micrometres, -4.08) + beta * std::pow(micrometres, -1.3)));
  };
  return {at(0.615), at(0.545), at(0.465)};
}

/// The direction of a place in the image, in texels.
Vec3d direction(double x, double y, const Image& image) {
  const double phi = 2 * pi * x / image.width, theta = pi * y / image.height;
  return {std::sin(theta) * std::sin(phi), std::cos(theta), -std::sin(theta) * std::cos(phi)};
}

/// Of a texel in row y, in steradians.
double solid_angle(int y, const Image& image) { return 4 * pi * share_of_row(y, image.height) / image.width; }

/// What share of each texel the sun's disc covers.
std::vector<double> sun_cover(const Vec3d& sun, const Image& image) {
  constexpr int steps = 16;
  const double margin = sun_radius + 3 * pi / image.height;
  std::vector<double> cover(image.pixels.size());
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      if (dot(direction(x + 0.5, y + 0.5, image), sun) < std::cos(margin)) continue;
      int inside = 0;
      for (int i = 0; i < steps * steps; ++i) {
        const Vec3d w = direction(x + (i % steps + 0.5) / steps, y + (i / steps + 0.5) / steps, image);
        inside += dot(w, sun) > std::cos(sun_radius);
      }
      cover[static_cast<std::size_t>(y * image.width + x)] = inside / double{steps * steps};
    }
  return cover;
}

void add_sun(const Sky& sky, const Vec3d& sun, Image& image) {
  const std::vector<double> cover = sun_cover(sun, image);
  double covered = 0;
  for (std::size_t i = 0; i < cover.size(); ++i)
    covered += cover[i] * solid_angle(static_cast<int>(i) / image.width, image);
  const Vec3d radiance =
      transmittance(sky.turbidity, std::acos(std::clamp(sun.y, -1.0, 1.0))) * (illuminance_outside / covered);
  for (std::size_t i = 0; i < cover.size(); ++i)
    image.pixels[i] = image.pixels[i] + Vec3f(radiance * cover[i]);
}

/// Of a level surface by the rows above the horizon.
Vec3d irradiance(const Image& image) {
  Vec3d sum;
  for (int y = 0; y < image.height / 2; ++y)
    for (int x = 0; x < image.width; ++x)
      sum += Vec3d(image.at(x, y)) * (solid_angle(y, image) * std::cos(pi * (y + 0.5) / image.height));
  return sum;
}

}  // namespace

Image sky_image(const Sky& sky, int height) {
  Image image(2 * height, height);
  const double azimuth = sky.sun_azimuth * pi / 180, elevation = sky.sun_elevation * pi / 180;
  const Vec3d sun{std::cos(elevation) * std::sin(azimuth), std::sin(elevation),
                  -std::cos(elevation) * std::cos(azimuth)};
  const ClearSky clear(sky.turbidity, pi / 2 - elevation);
  for (int y = 0; y < height / 2; ++y)
    for (int x = 0; x < image.width; ++x) {
      const Vec3d w = direction(x + 0.5, y + 0.5, image);
      image.at(x, y) = Vec3f(clear.radiance(w.y, std::acos(std::clamp(dot(w, sun), -1.0, 1.0))));
    }
  if (sky.sun) add_sun(sky, sun, image);
  const Vec3f ground(sky.ground * irradiance(image) / pi);
  std::fill(image.pixels.begin() + image.width * (height / 2), image.pixels.end(), ground);
  return image;
}

Image gradient_image(const Vec3d& zenith, const Vec3d& horizon, const Vec3d& ground, int height) {
  Image image(1, height);
  for (int y = 0; y < height; ++y) {
    const double sine = std::cos(pi * (y + 0.5) / height);
    image.at(0, y) = Vec3f(sine > 0 ? horizon + (zenith - horizon) * sine : ground);
  }
  return image;
}

}  // namespace castray
