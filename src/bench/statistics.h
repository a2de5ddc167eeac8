#pragma once

#include <optional>
#include <span>
#include <vector>

namespace castray {

/// The middle value; the mean of the two middle ones for an even count. `values` must not be empty.
double median(std::vector<double> values);

/// The index of a middle one of `values`, in ascending order; the lower one for an even count.
std::size_t median_index(const std::vector<double>& values);

/// 1 / (error * seconds): what N times the samples, or N times the speed, leaves as it is or multiplies by N.
double efficiency(double error, double seconds);

/// error = constant * seconds^-slope, by least squares on the logarithms. Of unbiased sampling with
/// independent random numbers the slope is 1.
struct PowerLaw {
  double slope = 1, constant = 0;
  bool is_fitted = false;  ///< else the slope is assumed: points of one time tell none

  double error_at(double seconds) const;
  /// When the error is reached; nothing if the error hardly falls (slope < 0.1), as that of a biased render.
  std::optional<double> seconds_to(double error) const;
};

struct TimeAndError {
  double seconds = 0, error = 0;
};

/// The fit through the points with seconds and error > 0; a single one (or several of one time) is given
/// slope 1. Nothing if no point is left.
std::optional<PowerLaw> fit_power_law(std::span<const TimeAndError> points);

}  // namespace castray
