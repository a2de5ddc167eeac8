#include "castray/noise_test.h"

#include <algorithm>
#include <cmath>
#include <functional>
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

/// Mean of some numbers, and the squared standard error of that mean.
struct Estimate {
  double mean = 0, variance = 0, freedom = 1;
};

Estimate estimate(const std::vector<double>& values) {
  const auto n = static_cast<double>(values.size());
  Estimate e;
  for (const double v : values) e.mean += v / n;
  for (const double v : values) e.variance += (v - e.mean) * (v - e.mean) / ((n - 1) * n);
  e.freedom = n - 1;
  return e;
}

std::vector<double> channel_of(const std::vector<Vec3d>& means, int channel) {
  std::vector<double> values;
  for (const Vec3d& mean : means) values.push_back(mean[channel]);
  return values;
}

/// One block and channel.
struct BlockTest {
  double mean = 0, mean_reference = 0, t = 0, p = 1;
};

BlockTest test_block(const std::vector<double>& values, const std::vector<double>& reference, bool paired) {
  const Estimate a = estimate(values), b = estimate(reference);
  BlockTest test{a.mean, b.mean, 0, 1};
  const double difference = a.mean - b.mean;
  if (std::abs(difference) <= 0x1p-17 * std::max(std::abs(a.mean), std::abs(b.mean))) return test;
  double variance = a.variance + b.variance;
  double freedom =
      variance * variance / (a.variance * a.variance / a.freedom + b.variance * b.variance / b.freedom);
  if (paired) {
    std::vector<double> differences(values.size());
    std::transform(values.begin(), values.end(), reference.begin(), differences.begin(), std::minus<>());
    variance = estimate(differences).variance;
    freedom = a.freedom;
  }
  test.t = difference / std::sqrt(variance);  // infinite where nothing is noisy
  test.p = t_test_p_value(test.t, std::isfinite(freedom) ? freedom : 1);
  return test;
}

/// The blocks of `size` x `size` noise blocks that cover `all`.
std::vector<Film::Blocks> groups_of(const Film::Blocks& all, int size) {
  std::vector<Film::Blocks> groups;
  for (int y = all.y0 / size * size; y < all.y1; y += size)
    for (int x = all.x0 / size * size; x < all.x1; x += size)
      groups.push_back(
          {std::max(x, all.x0), std::max(y, all.y0), std::min(x + size, all.x1), std::min(y + size, all.y1)});
  return groups;
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
  const Film::Blocks all = film.blocks();
  int sizes = 1;
  while (groups_of(all, 1 << (sizes - 1)).size() > 1) ++sizes;
  NoiseTest result;
  result.alpha = alpha;
  result.paired = film.samples == reference.samples &&
                  describe(film)["castray:seed"] == describe(reference)["castray:seed"];
  double smallest = std::numeric_limits<double>::infinity();
  for (int size = 0; size < sizes; ++size) {
    const std::vector<Film::Blocks> groups = groups_of(all, 1 << size);
    const double share = 3 * static_cast<double>(groups.size()) * sizes;
    for (const Film::Blocks& group : groups) {
      const auto means = film.replicate_means(group), reference_means = reference.replicate_means(group);
      for (int c = 0; c < 3; ++c) {
        ++result.tests;
        const BlockTest test =
            test_block(channel_of(means, c), channel_of(reference_means, c), result.paired);
        if (test.p * share >= smallest) continue;
        smallest = test.p * share;
        result.x0 = std::max(group.x0 * noise_block, window.x0);
        result.y0 = std::max(group.y0 * noise_block, window.y0);
        result.x1 = std::min(group.x1 * noise_block, window.x1);
        result.y1 = std::min(group.y1 * noise_block, window.y1);
        result.channel = c;
        result.t = test.t;
        result.mean = test.mean;
        result.mean_reference = test.mean_reference;
      }
    }
  }
  result.p = std::min(1.0, smallest);
  return result;
}

}  // namespace castray
