#include "castray/noise_test.h"

#include <fmt/core.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "castray/error.h"
#include "image/blocks.h"

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

/// One block and channel.
struct BlockTest {
  double mean = 0, mean_reference = 0, t = 0, p = 1;
};

// Differences that are not counted, relative: what the order of float operations can make, and the distance
// of two half floats, which a plain background may round to.
constexpr double float_rounding = 0x1p-17, half_rounding = 0x1p-10;

BlockTest test_difference(const Estimate& a, const Estimate& b, double variance, double freedom,
                          double rounding) {
  BlockTest test{a.mean, b.mean, 0, 1};
  if (std::abs(a.mean - b.mean) <= rounding * std::max(std::abs(a.mean), std::abs(b.mean))) return test;
  test.t = (a.mean - b.mean) / std::sqrt(variance);  // infinite where nothing is noisy
  test.p = t_test_p_value(test.t, freedom);
  return test;
}

/// The two are independent.
BlockTest test_welch(const Estimate& a, const Estimate& b, double rounding = float_rounding) {
  const double variance = a.variance + b.variance;
  return test_difference(
      a, b, variance,
      variance * variance / (a.variance * a.variance / a.freedom + b.variance * b.variance / b.freedom),
      rounding);
}

/// The values of one replicate in both share most of their noise.
BlockTest test_paired(const std::vector<double>& values, const std::vector<double>& reference) {
  std::vector<double> differences(values.size());
  std::transform(values.begin(), values.end(), reference.begin(), differences.begin(), std::minus<>());
  const Estimate difference = estimate(differences);
  return test_difference(estimate(values), estimate(reference), difference.variance, difference.freedom,
                         float_rounding);
}

/// The three channels of some blocks.
using TestBlocks = std::function<std::array<BlockTest, 3>(const Film::Blocks&)>;

/// Tests the blocks of all sizes.
NoiseTest test_all(const Window& window, double alpha, const TestBlocks& test_blocks) {
  const Film::Blocks all = Film::blocks_of(window);
  const int sizes = count_sizes(all);
  NoiseTest result;
  result.alpha = alpha;
  double smallest = std::numeric_limits<double>::infinity(), squares = 0;
  for (int size = 0; size < sizes; ++size) {
    const std::vector<Film::Blocks> groups = groups_of(all, 1 << size);
    const double share = 3 * static_cast<double>(groups.size()) * sizes;
    result.tests += 3 * groups.size();
    for (const Film::Blocks& group : groups) {
      const std::array<BlockTest, 3> tests = test_blocks(group);
      for (std::size_t c = 0; c < 3; ++c) {
        const BlockTest& test = tests[c];
        if (size == 0) squares += test.t * test.t;
        if (test.p * share >= smallest) continue;
        smallest = test.p * share;
        result.x0 = std::max(group.x0 * noise_block, window.x0);
        result.y0 = std::max(group.y0 * noise_block, window.y0);
        result.x1 = std::min(group.x1 * noise_block, window.x1);
        result.y1 = std::min(group.y1 * noise_block, window.y1);
        result.channel = static_cast<int>(c);
        result.t = test.t;
        result.mean = test.mean;
        result.mean_reference = test.mean_reference;
      }
    }
  }
  result.rms_t = std::sqrt(squares / (3 * static_cast<double>(groups_of(all, 1).size())));
  result.p = std::clamp(smallest, std::numeric_limits<double>::min(), 1.0);  // "below 0" would mean nothing
  return result;
}

/// Sums over the pixels of each noise block of an image, and from them estimates for groups of blocks.
class BlockSums {
 public:
  BlockSums(const Image& image, const Noise& noise)
      : columns_(Film::blocks_of({image.width, image.height, 0, 0, image.width, image.height}).x1),
        freedom_(noise.freedom) {
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x) {
        blocks_.resize(std::max(blocks_.size(), index(x / noise_block, y / noise_block) + 1));
        Sums& sums = blocks_[index(x / noise_block, y / noise_block)];
        sums.value += Vec3d(image.at(x, y));
        sums.variance += Vec3d(noise.variance.at(x, y));
        ++sums.pixels;
      }
  }

  Estimate estimate(const Film::Blocks& group, int channel) const {
    double value = 0, variance = 0, squares = 0, pixels = 0;
    for (int y = group.y0; y < group.y1; ++y)
      for (int x = group.x0; x < group.x1; ++x) {
        const Sums& sums = blocks_[index(x, y)];
        value += sums.value[channel];
        variance += sums.variance[channel];
        squares += sums.variance[channel] * sums.variance[channel];
        pixels += sums.pixels;
      }
    return {value / pixels, variance / (pixels * pixels), freedom_ * variance * variance / squares};
  }

 private:
  struct Sums {
    Vec3d value, variance;
    double pixels = 0;
  };
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(x);
  }

  int columns_;
  double freedom_;
  std::vector<Sums> blocks_;
};

void require_replicates(const Film& film, const char* which) {
  if (film.replicate_means({}).size() < 2)
    throw InputError(std::string("the ") + which +
                     " does not tell its noise; render it with --replicates R, R >= 2");
}

void require_noise(const ImageFile& file, const char* which) {
  if (!file.noise)
    throw InputError(
        std::string("the ") + which +
        " does not tell its noise; it must be a .film or .exr of 'castray render --replicates R', "
        "R >= 2, or have variances");
  const Image& variance = file.noise->variance;
  if (variance.width != file.image.width || variance.height != file.image.height)
    throw InputError(std::string("the variance of the ") + which + " has another size than the image");
  for (int y = 0; y < variance.height; ++y)
    for (int x = 0; x < variance.width; ++x) {
      const Vec3f& v = variance.at(x, y);
      if (!is_finite(v) || std::min({v.x, v.y, v.z}) < 0)
        throw InputError(fmt::format("pixel ({},{}) of the {} has a variance that is negative or not finite",
                                     x, y, which));
    }
  if (!(file.noise->freedom > 0))
    throw InputError(std::string("the ") + which + " has variances of no degree of freedom");
}

}  // namespace

double t_test_p_value(double t, double freedom) {
  constexpr double as_good_as_normal = 1e8;
  if (!std::isfinite(t)) return 0;
  if (freedom > as_good_as_normal) return std::erfc(std::abs(t) / std::numbers::sqrt2);
  return incomplete_beta(freedom / 2, 0.5, freedom / (freedom + t * t));
}

NoiseTest test_noise(const Film& film, const Film& reference, double alpha) {
  require_replicates(film, "image");
  require_replicates(reference, "reference");
  if (film.window() != reference.window()) throw InputError("the films show different windows");
  const bool paired = film.samples == reference.samples &&
                      describe(film)["castray:seed"] == describe(reference)["castray:seed"];
  NoiseTest result = test_all(film.window(), alpha, [&](const Film::Blocks& group) {
    const auto means = film.replicate_means(group), reference_means = reference.replicate_means(group);
    std::array<BlockTest, 3> tests;
    for (int c = 0; c < 3; ++c) {
      const std::vector<double> a = channel_of(means, c), b = channel_of(reference_means, c);
      tests[static_cast<std::size_t>(c)] = paired ? test_paired(a, b) : test_welch(estimate(a), estimate(b));
    }
    return tests;
  });
  result.paired = paired;
  return result;
}

NoiseTest test_noise(const ImageFile& image, const ImageFile& reference, double alpha) {
  require_noise(image, "image");
  require_noise(reference, "reference");
  const int width = image.image.width, height = image.image.height;
  if (width != reference.image.width || height != reference.image.height)
    throw InputError("the images are of different sizes");
  const BlockSums a(image.image, *image.noise), b(reference.image, *reference.noise);
  const double rounding =
      image.noise->of_halves || reference.noise->of_halves ? half_rounding : float_rounding;
  return test_all({width, height, 0, 0, width, height}, alpha, [&](const Film::Blocks& group) {
    const auto test = [&](int c) { return test_welch(a.estimate(group, c), b.estimate(group, c), rounding); };
    return std::array{test(0), test(1), test(2)};
  });
}

}  // namespace castray
