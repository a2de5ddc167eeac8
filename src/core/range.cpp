#include "core/range.h"

#include <fmt/core.h>

#include <cmath>

namespace castray {

bool Range::contains(double value) const {
  return (above_least ? value > least : value >= least) &&
         (below_greatest ? value < greatest : value <= greatest) &&
         (value == 0 || std::abs(value) >= least_but_zero);
}

std::string Range::text() const {
  const bool bounded_below = least > std::numeric_limits<double>::lowest();
  const bool bounded_above = greatest < std::numeric_limits<double>::max();
  const std::string low = least_but_zero > 0
                              ? fmt::format("0, or at least {}", least_but_zero)
                              : fmt::format("{} {}", above_least ? "greater than" : "at least", least);
  const std::string high = fmt::format("{} {}", below_greatest ? "less than" : "at most", greatest);
  if (!bounded_below) return bounded_above ? high : "finite";
  return bounded_above ? low + " and " + high : low;
}

}  // namespace castray
