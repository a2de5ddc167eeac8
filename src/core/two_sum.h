#pragma once

namespace castray {

/// A sum and its rounding error: sum + error is the exact value, sum its rounding to nearest.
struct ExactSum {
  double sum = 0, error = 0;
};

/// sum + error == a + b exactly (Knuth, TAOCP 2, 4.2.2).
inline ExactSum two_sum(double a, double b) {
  const double sum = a + b;
  const double from_b = sum - a;
  return {sum, (a - (sum - from_b)) + (b - from_b)};
}

}  // namespace castray
