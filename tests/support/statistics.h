#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

namespace castray::test {

/// P(|Z| > z) of a standard normal variable.
inline double two_sided_probability(double z) { return std::erfc(std::abs(z) / std::numbers::sqrt2); }

/// P(X > x) of a chi-square variable, by Wilson and Hilferty's cube root; good to 1e-3 relative in the bulk
/// from 10 degrees of freedom on, which a threshold of 1e-5 does not mind.
inline double chi_square_tail(double x, double degrees) {
  const double v = 2 / (9 * degrees);
  return std::erfc((std::cbrt(x / degrees) - (1 - v)) / std::sqrt(2 * v)) / 2;
}

/// Pearson's test: probability of counts at least as far from `expected` if those are right. Cells with an
/// expectation below 5 are pooled.
inline double chi_square_probability(const std::vector<double>& counts, const std::vector<double>& expected) {
  double statistic = 0, pooled_count = 0, pooled_expected = 0;
  int cells = 0;
  const auto add = [&](double count, double expectation) {
    statistic += (count - expectation) * (count - expectation) / expectation;
    ++cells;
  };
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (expected[i] >= 5) {
      add(counts[i], expected[i]);
    } else {
      pooled_count += counts[i];
      pooled_expected += expected[i];
    }
  }
  if (pooled_expected >= 1) add(pooled_count, pooled_expected);
  if (pooled_expected < 1 && pooled_count > 10) return 0;  // what should not happen does
  return cells > 1 ? chi_square_tail(statistic, cells - 1) : 1;
}

/// Mean and its standard error, of independent samples added one by one.
class Mean {
 public:
  void add(double x) {
    ++n_;
    const double d = x - mean_;
    mean_ += d / static_cast<double>(n_);
    squares_ += d * (x - mean_);
  }
  double mean() const { return mean_; }
  double variance() const { return n_ > 1 ? squares_ / static_cast<double>(n_ - 1) : 0; }
  double error() const { return std::sqrt(variance() / static_cast<double>(std::max<std::size_t>(n_, 1))); }

 private:
  std::size_t n_ = 0;
  double mean_ = 0, squares_ = 0;
};

/// Points and weights of the n-point Gauss-Legendre rule on [0,1].
struct GaussRule {
  std::vector<double> x, w;

  explicit GaussRule(int n) {
    for (int i = 0; i < n; ++i) {
      double t = std::cos(std::numbers::pi * (i + 0.75) / (n + 0.5)), slope = 1;
      for (int step = 0; step < 100; ++step) {  // Newton's method on P_n
        double p = 1, previous = 0;
        for (int k = 1; k <= n; ++k) {
          const double next = ((2 * k - 1) * t * p - (k - 1) * previous) / k;
          previous = p;
          p = next;
        }
        slope = n * (t * p - previous) / (t * t - 1);
        const double step_size = p / slope;
        t -= step_size;
        if (std::abs(step_size) < 1e-15) break;
      }
      x.push_back((1 - t) / 2);
      w.push_back(1 / ((1 - t * t) * slope * slope));
    }
  }
};

}  // namespace castray::test
