#include "lights/direction_bins.h"

#include <algorithm>
#include <cmath>

#include "lights/light_records.h"

namespace castray {

GridShares around(double x, std::size_t count) {
  const double at = std::clamp(x - 0.5, 0.0, static_cast<double>(count - 1));
  const auto first = static_cast<std::size_t>(at);
  return {GridShare{first, 1 - (at - std::floor(at))},
          GridShare{std::min(first + 1, count - 1), at - std::floor(at)}};
}

void spread(const Vec3d& w, double weight, double* row) {
  constexpr std::size_t steps = guide_steps;
  int axis = 0;
  for (int k = 1; k < 3; ++k)
    if (std::abs(w[k]) > std::abs(w[axis])) axis = k;
  const double most = std::abs(w[axis]);
  const auto on_face = [&](int k) { return (w[(axis + k) % 3] / most + 1) / 2 * double{guide_steps}; };
  const auto face = static_cast<std::size_t>(2 * axis + (w[axis] < 0 ? 1 : 0));
  for (const GridShare& a : around(on_face(1), steps))
    for (const GridShare& b : around(on_face(2), steps))
      row[(face * steps + a.at) * steps + b.at] += weight * (a.weight * b.weight);
}

std::vector<float> cumulative_of(const std::vector<double>& weights) {
  std::vector<float> cumulative;
  for (std::size_t row = 0; row < weights.size(); row += guide_bins) {
    double sum = 0, before = 0;
    for (std::size_t bin = 0; bin < guide_bins; ++bin) sum += weights[row + bin];
    cumulative.push_back(0);
    for (std::size_t bin = 0; bin < guide_bins; ++bin) {
      before += weights[row + bin] / sum;
      cumulative.push_back(static_cast<float>(std::min(before, 1.0)));
    }
    cumulative.back() = 1;
  }
  return cumulative;
}

}  // namespace castray
