#include "bench/statistics.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace castray {

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 ? values[middle] : (values[middle - 1] + values[middle]) / 2;
}

std::size_t median_index(const std::vector<double>& values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), 0);
  const auto middle = order.begin() + static_cast<std::ptrdiff_t>((order.size() - 1) / 2);
  std::nth_element(order.begin(), middle, order.end(),
                   [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
  return *middle;
}

double efficiency(double error, double seconds) { return 1 / (error * seconds); }

double PowerLaw::error_at(double seconds) const { return constant * std::pow(seconds, -slope); }

std::optional<double> PowerLaw::seconds_to(double error) const {
  constexpr double least_slope = 0.1;
  if (!(slope >= least_slope)) return std::nullopt;
  return std::pow(constant / error, 1 / slope);
}

std::optional<PowerLaw> fit_power_law(std::span<const TimeAndError> points) {
  std::vector<TimeAndError> logs;
  for (const TimeAndError& point : points)
    if (point.seconds > 0 && point.error > 0)
      logs.push_back({std::log(point.seconds), std::log(point.error)});
  if (logs.empty()) return std::nullopt;
  TimeAndError mean;
  for (const TimeAndError& point : logs) {
    mean.seconds += point.seconds / static_cast<double>(logs.size());
    mean.error += point.error / static_cast<double>(logs.size());
  }
  double spread = 0, covariance = 0;
  for (const TimeAndError& point : logs) {
    spread += (point.seconds - mean.seconds) * (point.seconds - mean.seconds);
    covariance += (point.seconds - mean.seconds) * (point.error - mean.error);
  }
  PowerLaw law;
  law.is_fitted = spread > 1e-12;
  if (law.is_fitted) law.slope = -covariance / spread;
  law.constant = std::exp(mean.error + law.slope * mean.seconds);
  return law;
}

}  // namespace castray
