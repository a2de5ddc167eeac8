#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "bench/noise_free.h"
#include "bench/statistics.h"

using namespace castray;

TEST_CASE("the median is the middle value, or the mean of the middle two") {
  REQUIRE(median({3, 1, 2}) == 2);
  REQUIRE(median({4, 1, 3, 2}) == 2.5);
  REQUIRE(median({7}) == 7);
}

TEST_CASE("efficiency does not change where twice the time halves the error") {
  REQUIRE(efficiency(0.01, 2) == Approx(50));
  REQUIRE(efficiency(0.005, 4) == Approx(efficiency(0.01, 2)));
}

TEST_CASE("a power law is found exactly from points on it") {
  std::vector<TimeAndError> points;
  for (const double seconds : {0.2, 0.9, 4.0, 17.0})
    points.push_back({seconds, 0.03 * std::pow(seconds, -1.16)});
  const auto law = fit_power_law(points);
  REQUIRE(law);
  REQUIRE(law->slope == Approx(1.16));
  REQUIRE(law->is_fitted);
  REQUIRE(law->constant == Approx(0.03));
  REQUIRE(law->error_at(2.5) == Approx(0.03 * std::pow(2.5, -1.16)));
  for (const double error : {1e-2, 1e-4}) REQUIRE(law->error_at(*law->seconds_to(error)) == Approx(error));
}

TEST_CASE("the median has an index") {
  REQUIRE(median_index({5}) == 0);
  REQUIRE(median_index({3, 1, 2}) == 2);
  REQUIRE(median_index({4, 1, 3, 2}) == 3);
}

TEST_CASE("the fit is that of least squares on the logarithms") {
  // log10 points (0,0), (1,-1), (2,-1.4): by hand, slope -0.7, intercept -0.1.
  const std::vector<TimeAndError> points{{1, 1}, {10, 0.1}, {100, std::pow(10, -1.4)}};
  const auto law = fit_power_law(points);
  REQUIRE(law->slope == Approx(0.7));
  REQUIRE(law->constant == Approx(std::pow(10, -0.1)));
}

TEST_CASE("a fit of one point takes slope 1, of none does not exist, of growing error never ends") {
  const std::vector<TimeAndError> one{{2, 0.01}};
  REQUIRE(fit_power_law(one)->slope == 1);
  REQUIRE_FALSE(fit_power_law(one)->is_fitted);
  REQUIRE(*fit_power_law(one)->seconds_to(0.001) == Approx(20));
  const std::vector<TimeAndError> useless{{0, 1}, {1, -1e-9}};
  REQUIRE_FALSE(fit_power_law(useless));
  const std::vector<TimeAndError> growing{{1, 0.01}, {2, 0.02}};
  const TimeAndError flat[] = {{1, 0.0101}, {100, 0.01}};
  REQUIRE_FALSE(fit_power_law(flat)->seconds_to(0.001));
  REQUIRE_FALSE(fit_power_law(growing)->seconds_to(0.001));
}

namespace {

/// `truth` with independent normal noise of standard deviation `sigma` on each component.
Image noisy(const Image& truth, double sigma, unsigned seed) {
  std::mt19937 engine(seed);
  std::normal_distribution<double> noise(0, sigma);
  Image image = truth;
  for (Vec3f& pixel : image.pixels)
    for (int c = 0; c < 3; ++c) pixel[c] = static_cast<float>(pixel[c] + noise(engine));
  return image;
}

Image gradient() {
  Image image(200, 150);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      image.at(x, y) = {0.5f + 0.002f * static_cast<float>(x), 1.0f, 0.7f + 0.001f * static_cast<float>(y)};
  return image;
}

}  // namespace

TEST_CASE("the error of an image is measured free of the references' larger noise") {
  const Image truth = gradient();
  const double sigma = 0.02, reference_sigma = 0.1;
  const ReferencePair reference{noisy(truth, reference_sigma, 1), noisy(truth, reference_sigma, 2)};
  const NoiseFreeErrors errors = noise_free_errors(noisy(truth, sigma, 3), reference);
  // Var (e-a)(e-b) = s^4 2 + 2 s^2 r^2 + r^4 for normal e, a, b: standard error over n components.
  const double s2 = sigma * sigma, r2 = reference_sigma * reference_sigma;
  const double n = 3.0 * static_cast<double>(truth.pixels.size());
  const double standard_error = std::sqrt((2 * s2 * s2 + 2 * s2 * r2 + r2 * r2) / n);
  REQUIRE(std::abs(errors.mse - s2) < 4 * standard_error);  // false alarms: 6e-5, and the seeds are fixed
  REQUIRE(errors.mse < 0.1 * r2);                           // a single reference would add r2 / 2
  const NoiseFreeErrors of_truth = noise_free_errors(truth, reference);
  REQUIRE(std::abs(of_truth.mse) < 4 * r2 / std::sqrt(n));
}

TEST_CASE("relMSE divides by the squared reference plus 0.01") {
  Image x(1, 1), r(1, 1);
  x.at(0, 0) = {1.5f, 0.25f, 0};
  r.at(0, 0) = {1.0f, 0.0f, 0};
  const NoiseFreeErrors errors = noise_free_errors(x, {r, r});
  REQUIRE(errors.mse == Approx((0.25 + 0.0625) / 3));
  REQUIRE(errors.relmse == Approx((0.25 / 1.01 + 0.0625 / 0.01) / 3));
}

TEST_CASE("the noise of a reference is that of the mean of its halves") {
  const Image truth = gradient();
  const ReferencePair reference{noisy(truth, 0.02, 5), noisy(truth, 0.02, 6)};
  const NoiseFreeErrors against_truth = noise_free_errors(reference.mean(), {truth, truth});
  REQUIRE(reference_noise(reference) == Approx(against_truth.relmse).epsilon(0.02));
}

TEST_CASE("the mask leaves out emitters and their neighbours, and only them count not") {
  Image emission(5, 4);
  emission.at(1, 1) = {0, 2, 0};
  const PixelMask mask = away_from_emitters(emission);
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 5; ++x) REQUIRE(mask[static_cast<std::size_t>(y * 5 + x)] == (x > 2 || y > 2));
  Image bad(5, 4), black(5, 4);
  bad.at(2, 2) = {9, 9, 9};
  REQUIRE(noise_free_errors(bad, {black, black}, mask).mse == 0);
  REQUIRE(noise_free_errors(bad, {black, black}).mse == Approx(81.0 / 20));
}
