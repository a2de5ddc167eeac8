#pragma once

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include "castray/image.h"
#include "statistics.h"

namespace castray::test {

/// Two independent renders of a standard scene by another program; tests/golden/README.md.
struct ReferencePair {
  Image a, b;

  explicit ReferencePair(const std::string& scene) : a(read(scene + "_A")), b(read(scene + "_B")) {}

  Vec3d mean(std::size_t pixel) const { return (Vec3d(a.pixels[pixel]) + Vec3d(b.pixels[pixel])) * 0.5; }

  /// relMSE of `x`, free of the references' noise.
  double relmse(const Image& x) const {
    double sum = 0;
    for (std::size_t i = 0; i < x.pixels.size(); ++i)
      for (int c = 0; c < 3; ++c) {
        const double r = mean(i)[c], v = x.pixels[i][c];
        sum += (v - a.pixels[i][c]) * (v - b.pixels[i][c]) / (r * r + 0.01);
      }
    return sum / (3 * static_cast<double>(x.pixels.size()));
  }

 private:
  static Image read(const std::string& name) {
    return read_image(std::string(CASTRAY_ROOT) + "/tests/golden/reference/" + name + ".pfm").image;
  }
};

/// Means of a channel over blocks of size x size pixels.
inline std::vector<double> block_means(const Image& image, int size) {
  const int columns = image.width / size, rows = image.height / size;
  std::vector<double> means(3 * static_cast<std::size_t>(columns * rows));
  for (int y = 0; y < rows * size; ++y)
    for (int x = 0; x < columns * size; ++x)
      for (int c = 0; c < 3; ++c)
        means[static_cast<std::size_t>(3 * (y / size * columns + x / size) + c)] +=
            static_cast<double>(image.at(x, y)[c]) / (size * size);
  return means;
}

/// z-scores of the blocks of several independent renders of one image against what they should be on average.
struct BlockScores {
  double largest = 0, rms = 0;
  std::size_t count = 0;
  double independent = 0;  ///< as many independent scores would have so uncertain a mean square
};

/// Block by block, the mean of some renders and the variance of that mean.
struct ExpectedBlocks {
  std::vector<double> mean, variance;

  explicit ExpectedBlocks(const std::vector<std::vector<double>>& renders) {
    for (std::size_t i = 0; i < renders[0].size(); ++i) {
      Mean m;
      for (const auto& render : renders) m.add(render[i]);
      mean.push_back(m.mean());
      variance.push_back(m.error() * m.error());
    }
  }
};

/// Of `count` normal scores with correlations rho, the mean square has the variance 2 sum(rho^2) / count^2,
/// as that of count^2 / sum(rho^2) independent ones. `unit`: by score, its deviations over the renders, as a
/// vector of length 1. Where rho is 0 its estimate squared is 1 / degrees on average, which is taken off.
inline double independent_scores(const std::vector<std::vector<double>>& unit, double degrees) {
  const auto count = static_cast<double>(unit.size());
  double squares = 0;
  for (const auto& a : unit)
    for (const auto& b : unit) {
      const double rho = std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
      squares += rho * rho;
    }
  const double corrected = (squares - count * count / degrees) / (1 - 1 / degrees);
  return count * count / std::max(corrected, count);
}

/// `variance`: of `expected` itself. A score follows Student's t; it is turned into a normal one of the same
/// probability (Wallace 1959). Blocks without any variance are left out.
inline BlockScores block_scores(const std::vector<std::vector<double>>& renders,
                                const std::vector<double>& expected, const std::vector<double>& variance) {
  constexpr double rounding = 4e-6;  // of sums of floats, which is all that skies differ by
  BlockScores scores;
  const auto degrees = static_cast<double>(renders.size() - 1);
  std::vector<std::vector<double>> unit;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    Mean mean;
    for (const auto& render : renders) mean.add(render[i]);
    const double noise = std::sqrt(mean.error() * mean.error() + variance[i]);
    const double error = noise > 0 ? std::hypot(noise, rounding * expected[i]) : 0;
    if (!(error > 0)) continue;
    const double t = (mean.mean() - expected[i]) / error;
    const double z = (8 * degrees + 1) / (8 * degrees + 3) * std::sqrt(degrees * std::log1p(t * t / degrees));
    scores.largest = std::max(scores.largest, z);
    scores.rms += z * z;
    ++scores.count;
    if (!(mean.variance() > 0)) continue;
    std::vector<double>& deviations = unit.emplace_back();
    for (const auto& render : renders)
      deviations.push_back((render[i] - mean.mean()) / std::sqrt(mean.variance() * degrees));
  }
  scores.independent = independent_scores(unit, degrees);
  scores.rms = std::sqrt(scores.rms / static_cast<double>(std::max<std::size_t>(scores.count, 1)));
  return scores;
}

/// 1.25; or, where blocks are so alike that chance exceeds it more often than 1 in 10,000 times, what it
/// exceeds so often, by the distribution of chi^2 (Wilson and Hilferty 1931).
inline double rms_limit(const BlockScores& scores) {
  constexpr double quantile = 3.72, always_allowed = 1.25;
  const double part = 2 / (9 * std::max(scores.independent, 1.0));
  return std::max(always_allowed, std::pow(1 - part + quantile * std::sqrt(part), 1.5));
}

/// The |z| that the largest of `count` scores exceeds with probability `false_alarm`.
inline double score_limit(std::size_t count, double false_alarm) {
  double low = 0, high = 10;
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (two_sided_probability(middle) * static_cast<double>(count) > false_alarm ? low : high) = middle;
  }
  return high;
}

}  // namespace castray::test
