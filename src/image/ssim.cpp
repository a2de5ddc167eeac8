#include <cmath>

#include "castray/metrics.h"
#include "image/convolve.h"

namespace castray {

namespace {

constexpr int radius = 5;
constexpr double sigma = 1.5;

Plane product(const Plane& a, const Plane& b) {
  Plane result(a.width, a.height);
  for (std::size_t i = 0; i < result.values.size(); ++i) result.values[i] = a.values[i] * b.values[i];
  return result;
}

double mean_ssim(const Plane& a, const Plane& b) {
  constexpr double c1 = 0.01 * 0.01, c2 = 0.03 * 0.03;
  const Taps gaussian =
      normalised(make_taps(radius, [](int i) { return std::exp(-i * i / (2 * sigma * sigma)); }));
  const auto blur = [&](const Plane& plane) { return convolve(plane, gaussian, gaussian, Border::cut); };
  const Plane mean_a = blur(a), mean_b = blur(b);
  const Plane mean_aa = blur(product(a, a)), mean_bb = blur(product(b, b)), mean_ab = blur(product(a, b));
  const int skip_x = a.width > 2 * radius ? radius : 0, skip_y = a.height > 2 * radius ? radius : 0;
  double sum = 0;
  for (int y = skip_y; y < a.height - skip_y; ++y)
    for (int x = skip_x; x < a.width - skip_x; ++x) {
      const double ma = mean_a.at(x, y), mb = mean_b.at(x, y);
      const double variances = mean_aa.at(x, y) - ma * ma + mean_bb.at(x, y) - mb * mb;
      const double covariance = mean_ab.at(x, y) - ma * mb;
      sum += (2 * ma * mb + c1) * (2 * covariance + c2) / ((ma * ma + mb * mb + c1) * (variances + c2));
    }
  return sum / ((a.width - 2.0 * skip_x) * (a.height - 2.0 * skip_y));
}

}  // namespace

double ssim(const Image& shown, const Image& reference) {
  double sum = 0;
  for (int c = 0; c < 3; ++c) sum += mean_ssim(plane_of(shown, c), plane_of(reference, c));
  return sum / 3;
}

}  // namespace castray
