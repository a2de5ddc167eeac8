#include "castray/noise_test.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "castray/error.h"

namespace castray {

namespace {

/// The continued fraction of the incomplete beta function (DLMF 8.17.22), by Lentz's method; good for
/// x < (a+1)/(a+b+2).
double beta_fraction(double a, double b, double x) {
  constexpr double tiny = 1e-300;
  const auto nonzero = [](double v) { return std::abs(v) < tiny ? tiny : v; };
  double c = 1, d = 1 / nonzero(1 - (a + b) * x / (a + 1)), f = d;
  for (int m = 1; m <= 1000; ++m) {
    const double even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m));
    const double odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1));
    double change = 1;
    for (const double term : {even, odd}) {
      d = 1 / nonzero(1 + term * d);
      c = nonzero(1 + term / c);
      change = c * d;
      f *= change;
    }
    if (std::abs(change - 1) < 1e-15) break;
  }
  return f;
}

/// The regularised incomplete beta function I_x(a,b).
double incomplete_beta(double a, double b, double x) {
  if (x <= 0) return 0;
  if (x >= 1) return 1;
  const double front =
      std::exp(std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) + a * std::log(x) + b * std::log1p(-x));
  if (x < (a + 1) / (a + b + 2)) return front * beta_fraction(a, b, x) / a;
  return 1 - front * beta_fraction(b, a, 1 - x) / b;
}

/// Mean of the replicates, and the squared standard error of that mean.
struct Estimate {
  double mean = 0, variance = 0, replicates = 0;
};

Estimate estimate(const std::vector<Vec3d>& means, int channel) {
  Estimate e;
  e.replicates = static_cast<double>(means.size());
  for (const Vec3d& mean : means) e.mean += mean[channel] / e.replicates;
  double squares = 0;
  for (const Vec3d& mean : means) squares += (mean[channel] - e.mean) * (mean[channel] - e.mean);
  e.variance = squares / (e.replicates - 1) / e.replicates;
  return e;
}

struct Welch {
  double t = 0, freedom = 1;
};

Welch welch(const Estimate& a, const Estimate& b) {
  constexpr double rounding = 4 * std::numeric_limits<float>::epsilon();
  const double floor = rounding * std::max(std::abs(a.mean), std::abs(b.mean));
  const double variance = a.variance + b.variance, difference = a.mean - b.mean;
  if (std::abs(difference) <= floor) return {};
  const double freedom =
      variance * variance /
      (a.variance * a.variance / (a.replicates - 1) + b.variance * b.variance / (b.replicates - 1));
  const double t = difference / std::sqrt(variance);  // infinite where nothing is noisy
  return {t, std::isfinite(freedom) ? freedom : 1};
}

void require_replicates(const Film& film, const char* which) {
  if (film.replicate_means({}).size() < 2)
    throw InputError(
        std::string("the ") + which +
        " does not tell its noise; it must be a .film of 'castray render --replicates R' with R >= 2");
}

}  // namespace

double t_test_p_value(double t, double freedom) {
  if (!std::isfinite(t)) return 0;
  return incomplete_beta(freedom / 2, 0.5, freedom / (freedom + t * t));
}

NoiseTest test_noise(const Film& film, const Film& reference, double alpha) {
  require_replicates(film, "image");
  require_replicates(reference, "reference");
  const Window& window = film.window();
  if (window != reference.window()) throw InputError("the films show different windows");
  NoiseTest result;
  result.alpha = alpha;
  const Film::Blocks all = film.blocks();
  double smallest = 1;
  for (int size = 1;; size *= 2) {
    for (int y = all.y0 / size * size; y < all.y1; y += size)
      for (int x = all.x0 / size * size; x < all.x1; x += size) {
        const Film::Blocks group{std::max(x, all.x0), std::max(y, all.y0), std::min(x + size, all.x1),
                                 std::min(y + size, all.y1)};
        const auto means = film.replicate_means(group), reference_means = reference.replicate_means(group);
        for (int c = 0; c < 3; ++c) {
          ++result.tests;
          const Estimate a = estimate(means, c), b = estimate(reference_means, c);
          const Welch test = welch(a, b);
          const double p = t_test_p_value(test.t, test.freedom);
          if (p >= smallest && smallest < 1) continue;
          smallest = p;
          result.x0 = std::max(group.x0 * noise_block, window.x0);
          result.y0 = std::max(group.y0 * noise_block, window.y0);
          result.x1 = std::min(group.x1 * noise_block, window.x1);
          result.y1 = std::min(group.y1 * noise_block, window.y1);
          result.channel = c;
          result.t = test.t;
          result.mean = a.mean;
          result.mean_reference = b.mean;
        }
      }
    if (size >= all.x1 && size >= all.y1) break;
  }
  result.p = std::min(1.0, smallest * static_cast<double>(result.tests));
  return result;
}

}  // namespace castray
