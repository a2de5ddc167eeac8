#pragma once

namespace castray {

/// A sum and its rounding error: sum + error is the exact value, sum its rounding to nearest. Of doubles, or
/// of vectors of them.
template <class Real>
struct ExactSum {
  Real sum{}, error{};
};

/// exact.sum + exact.error == a + b exactly (Knuth, TAOCP 2, 4.2.2).
template <class Real>
void two_sum(const Real& a, const Real& b, ExactSum<Real>& exact) {
  exact.sum = a + b;
  const Real from_b = exact.sum - a;
  exact.error = (a - (exact.sum - from_b)) + (b - from_b);
}

}  // namespace castray
