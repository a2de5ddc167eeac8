#include "core/range.h"

#include <fmt/core.h>

namespace castray {

bool Range::contains(double value) const {
  return (above_least ? value > least : value >= least) &&
         (below_greatest ? value < greatest : value <= greatest);
}

std::string Range::text() const {
  const bool bounded_below = least > std::numeric_limits<double>::lowest();
  const bool bounded_above = greatest < std::numeric_limits<double>::max();
  const std::string low = fmt::format("{} {}", above_least ? "greater than" : "at least", least);
  const std::string high = fmt::format("{} {}", below_greatest ? "less than" : "at most", greatest);
  if (!bounded_below) return bounded_above ? high : "finite";
  return bounded_above ? low + " and " + high : low;
}

}  // namespace castray
