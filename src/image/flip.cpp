#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

#include "castray/metrics.h"
#include "image/convolve.h"

// FLIP after Andersson et al., "FLIP: A Difference Evaluator for Alternating Images" (HPG 2020), section 4,
// with the constants given there; its HDR form after Andersson et al., "Visualizing Errors in Rendered High
// Dynamic Range Images" (Eurographics short papers 2021). Equation numbers in comments are those of the
// first.

namespace castray {

namespace {

using std::numbers::pi;

constexpr double pixels_per_degree = 67.02;

/// Linear RGB of Rec. 709 to XYZ; the sum of each row is the white point D65.
constexpr double to_xyz[3][3] = {{10135552.0 / 24577794, 8788810.0 / 24577794, 4435075.0 / 24577794},
                                 {2613072.0 / 12288897, 8788810.0 / 12288897, 887015.0 / 12288897},
                                 {1425312.0 / 73733382, 8788810.0 / 73733382, 70074185.0 / 73733382}};

Vec3d white() {
  Vec3d sum;
  for (int i = 0; i < 3; ++i) sum[i] = to_xyz[i][0] + to_xyz[i][1] + to_xyz[i][2];
  return sum;
}

/// XYZ relative to white.
Vec3d relative_xyz(const Vec3d& rgb) {
  Vec3d xyz;
  for (int i = 0; i < 3; ++i) xyz[i] = dot(Vec3d(to_xyz[i][0], to_xyz[i][1], to_xyz[i][2]), rgb) / white()[i];
  return xyz;
}

struct Matrix {
  Vec3d row[3];
  Vec3d operator*(const Vec3d& v) const { return {dot(row[0], v), dot(row[1], v), dot(row[2], v)}; }
};

/// The inverse of `relative_xyz`.
Matrix from_relative_xyz() {
  Vec3d column[3];
  for (int i = 0; i < 3; ++i) {
    Vec3d unit;
    unit[i] = 1;
    column[i] = relative_xyz(unit);
  }
  const double determinant = dot(column[0], cross(column[1], column[2]));
  return {{cross(column[1], column[2]) / determinant, cross(column[2], column[0]) / determinant,
           cross(column[0], column[1]) / determinant}};
}

/// The opponent space YCxCz that the eye's filters work in.
Vec3d to_opponent(const Vec3d& rgb) {
  const Vec3d v = relative_xyz(rgb);
  return {116 * v.y - 16, 500 * (v.x - v.y), 200 * (v.y - v.z)};
}

Vec3d from_opponent(const Vec3d& v) {
  static const Matrix inverse = from_relative_xyz();
  const double y = (v.x + 16) / 116;
  return inverse * Vec3d(y + v.y / 500, y, y - v.z / 200);
}

/// CIELAB with a and b scaled by lightness (Hunt effect, eq. 6).
Vec3d to_hunt_lab(const Vec3d& rgb) {
  constexpr double delta = 6.0 / 29;
  const auto f = [](double t) {
    return t > delta * delta * delta ? std::cbrt(t) : t / (3 * delta * delta) + 4.0 / 29;
  };
  const Vec3d v = relative_xyz(rgb);
  const double fx = f(v.x), fy = f(v.y), fz = f(v.z), lightness = 116 * fy - 16;
  return {lightness, 0.01 * lightness * 500 * (fx - fy), 0.01 * lightness * 200 * (fy - fz)};
}

/// The HyAB distance (eq. 7).
double hyab(const Vec3d& a, const Vec3d& b) { return std::abs(a.x - b.x) + std::hypot(a.y - b.y, a.z - b.z); }

/// Contrast sensitivity as sums of Gaussians a sqrt(pi/b) exp(-pi^2 d^2/b) of the angle d in degrees (eq. 2,
/// table 1).
struct Gaussian {
  double a, b;
};
constexpr std::array<std::array<Gaussian, 2>, 3> sensitivity{
    {{{{1, 0.0047}, {0, 1e-5}}}, {{{1, 0.0053}, {0, 1e-5}}}, {{{34.1, 0.04}, {13.5, 0.025}}}}};

Plane eye_filter(const Plane& plane, const std::array<Gaussian, 2>& gaussians) {
  const int radius = static_cast<int>(std::ceil(3 * std::sqrt(0.04 / (2 * pi * pi)) * pixels_per_degree));
  Plane result(plane.width, plane.height);
  double total = 0;
  for (const Gaussian& g : gaussians) {
    if (g.a == 0) continue;
    const Taps taps = make_taps(radius, [&](int i) {
      const double degrees = i / pixels_per_degree;
      return std::exp(-pi * pi * degrees * degrees / g.b);
    });
    const double sum = std::accumulate(taps.begin(), taps.end(), 0.0), weight = g.a * std::sqrt(pi / g.b);
    total += weight * sum * sum;
    const Plane blurred = convolve(plane, taps, taps, Border::clamp);
    for (std::size_t i = 0; i < result.values.size(); ++i)
      result.values[i] += static_cast<float>(weight * blurred.values[i]);
  }
  for (float& value : result.values) value = static_cast<float>(value / total);
  return result;
}

/// Positive weights scaled to sum 1, negative ones to -1.
Taps balanced(Taps taps) {
  double positive = 0, negative = 0;
  for (const double tap : taps) (tap > 0 ? positive : negative) += std::abs(tap);
  for (double& tap : taps) tap /= tap > 0 ? positive : negative;
  return taps;
}

/// Strength of edges and of points per pixel, from lightness in [0,1] (section 4.2).
struct Features {
  Plane edge, point;
};

Plane magnitude(const Plane& a, const Plane& b) {
  Plane result(a.width, a.height);
  for (std::size_t i = 0; i < result.values.size(); ++i)
    result.values[i] = std::hypot(a.values[i], b.values[i]);
  return result;
}

Features find_features(const Plane& lightness) {
  constexpr double sigma = 0.5 * 0.082 * pixels_per_degree;
  const int radius = static_cast<int>(std::ceil(3 * sigma));
  const auto g = [](int i) { return std::exp(-i * i / (2 * sigma * sigma)); };
  const Taps smooth = normalised(make_taps(radius, g));
  const Taps first = balanced(make_taps(radius, [&](int i) { return -i * g(i); }));
  const Taps second =
      balanced(make_taps(radius, [&](int i) { return (i * i / (sigma * sigma) - 1) * g(i); }));
  const auto both = [&](const Taps& taps) {
    return magnitude(convolve(lightness, taps, smooth, Border::clamp),
                     convolve(lightness, smooth, taps, Border::clamp));
  };
  return {both(first), both(second)};
}

/// What the eye makes of an image of linear light in [0,1].
struct Percept {
  std::vector<Vec3d> colours;  ///< Hunt-adjusted CIELAB after the eye's filters
  Features features;
};

Percept perceive(const Image& light) {
  Image opponent(light.width, light.height);
  Plane lightness(light.width, light.height);
  for (std::size_t i = 0; i < light.pixels.size(); ++i) {
    const Vec3d v = to_opponent(Vec3d(light.pixels[i]));
    opponent.pixels[i] = Vec3f(v);
    lightness.values[i] = static_cast<float>((v.x + 16) / 116);
  }
  const std::array<Plane, 3> filtered{eye_filter(plane_of(opponent, 0), sensitivity[0]),
                                      eye_filter(plane_of(opponent, 1), sensitivity[1]),
                                      eye_filter(plane_of(opponent, 2), sensitivity[2])};
  std::vector<Vec3d> colours(light.pixels.size());
  for (std::size_t i = 0; i < colours.size(); ++i) {
    Vec3d rgb = from_opponent({filtered[0].values[i], filtered[1].values[i], filtered[2].values[i]});
    for (int c = 0; c < 3; ++c) rgb[c] = std::clamp(rgb[c], 0.0, 1.0);
    colours[i] = to_hunt_lab(rgb);
  }
  return {std::move(colours), find_features(lightness)};
}

/// Colour difference to [0,1], large ones compressed (eq. 8).
double colour_error(const Vec3d& a, const Vec3d& b) {
  constexpr double exponent = 0.7, knee_at = 0.4, knee_to = 0.95;
  static const double greatest = std::pow(hyab(to_hunt_lab({0, 1, 0}), to_hunt_lab({0, 0, 1})), exponent);
  const double error = std::pow(hyab(a, b), exponent), knee = knee_at * greatest;
  return error < knee ? knee_to / knee * error : knee_to + (error - knee) / (greatest - knee) * (1 - knee_to);
}

/// FLIP of two images of linear light in [0,1], per pixel.
std::vector<float> flip_map(const Image& test, const Image& reference) {
  const Percept a = perceive(test), b = perceive(reference);
  std::vector<float> errors(test.pixels.size());
  for (std::size_t i = 0; i < errors.size(); ++i) {
    const double feature =
        std::max(std::abs(double(a.features.edge.values[i]) - b.features.edge.values[i]),
                 std::abs(double(a.features.point.values[i]) - b.features.point.values[i]));
    const double feature_error = std::sqrt(feature / std::numbers::sqrt2);
    errors[i] = static_cast<float>(std::pow(colour_error(a.colours[i], b.colours[i]), 1 - feature_error));
  }
  return errors;
}

double mean(const std::vector<float>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// The filmic curve that HDR FLIP shows exposures through (Narkowicz' fit of ACES, with its scale of 0.6), a
/// ratio of polynomials in light.
constexpr double tone_top[2] = {0.6 * 0.6 * 2.51, 0.6 * 0.03};
constexpr double tone_bottom[3] = {0.6 * 0.6 * 2.43, 0.6 * 0.59, 0.14};

double filmic(double v) {
  v = std::max(v, 0.0);
  const double top = (tone_top[0] * v + tone_top[1]) * v;
  const double bottom = (tone_bottom[0] * v + tone_bottom[1]) * v + tone_bottom[2];
  return std::isfinite(bottom) ? std::clamp(top / bottom, 0.0, 1.0) : 1;
}

/// First and last exposure, in stops, of HDR FLIP: the brightest pixel, and the median, shown at 0.85.
struct Exposures {
  double first = 0, last = 0;
  int count = 2;
};

Exposures choose_exposures(const Image& reference) {
  constexpr double shown = 0.85;
  const double a = tone_top[0] - shown * tone_bottom[0], b = tone_top[1] - shown * tone_bottom[1];
  const double c = -shown * tone_bottom[2];
  const double root = (-b + std::sqrt(b * b - 4 * a * c)) / (2 * a);
  std::vector<double> luminances;
  for (const Vec3f& v : reference.pixels) luminances.push_back(std::max(0.0, relative_xyz(Vec3d(v)).y));
  std::sort(luminances.begin(), luminances.end());
  const double median = std::max(luminances[(luminances.size() - 1) / 2], 1e-9);
  const double brightest = std::max(luminances.back(), median);
  Exposures exposures{std::log2(root / brightest), std::log2(root / median), 2};
  exposures.count = std::max(2, static_cast<int>(std::ceil(exposures.last - exposures.first)));
  return exposures;
}

}  // namespace

double flip(const Image& shown, const Image& reference) {
  const ToneCurve srgb;
  return mean(flip_map(decoded({shown, true, {}}, srgb), decoded({reference, true, {}}, srgb)));
}

double flip_hdr(const Image& image, const Image& reference) {
  const Exposures exposures = choose_exposures(reference);
  const auto exposed = [](const Image& radiance, double stops) {
    Image light(radiance.width, radiance.height);
    for (std::size_t i = 0; i < light.pixels.size(); ++i)
      for (int c = 0; c < 3; ++c)
        light.pixels[i][c] = static_cast<float>(filmic(radiance.pixels[i][c] * std::exp2(stops)));
    return light;
  };
  std::vector<float> worst(reference.pixels.size(), 0.f);
  for (int i = 0; i < exposures.count; ++i) {
    const double stops = exposures.first + (exposures.last - exposures.first) * i / (exposures.count - 1);
    const std::vector<float> errors = flip_map(exposed(image, stops), exposed(reference, stops));
    std::transform(errors.begin(), errors.end(), worst.begin(), worst.begin(),
                   [](float a, float b) { return std::max(a, b); });
  }
  return mean(worst);
}

}  // namespace castray
