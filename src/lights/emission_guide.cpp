#include "lights/emission_guide.h"

#include <algorithm>
#include <cmath>

namespace castray {

namespace {

constexpr float cells_along = 4;  // the longest side of where samples start
constexpr std::uint32_t steps = guide_steps;

struct Share {
  std::size_t at;
  double weight;
};

/// The two places of a grid of `count` whose centres are around x, with linear weights; the last or first one
/// twice beyond.
std::array<Share, 2> around(double x, std::size_t count) {
  const double at = std::clamp(x - 0.5, 0.0, static_cast<double>(count - 1));
  const auto first = static_cast<std::size_t>(at);
  return {Share{first, 1 - (at - std::floor(at))},
          Share{std::min(first + 1, count - 1), at - std::floor(at)}};
}

/// Calls add(bin, weight) for the bins around a direction.
template <class Add>
void spread(const Vec3d& w, Add add) {
  int axis = 0;
  for (int k = 1; k < 3; ++k)
    if (std::abs(w[k]) > std::abs(w[axis])) axis = k;
  const double most = std::abs(w[axis]);
  const auto on_face = [&](int k) { return (w[(axis + k) % 3] / most + 1) / 2 * steps; };
  const auto face = static_cast<std::size_t>(2 * axis + (w[axis] < 0 ? 1 : 0));
  for (const Share& a : around(on_face(1), steps))
    for (const Share& b : around(on_face(2), steps))
      add((face * steps + a.at) * steps + b.at, a.weight * b.weight);
}

/// Of rows of weights of bins: for each row guide_bins + 1 numbers, from 0 to 1.
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

}  // namespace

EmissionGuide::EmissionGuide(const std::vector<UsefulEmission>& samples) {
  if (samples.empty()) return;
  lay_grid(samples);
  cumulative_ = cumulative_of(bin_weights(samples));
}

void EmissionGuide::lay_grid(const std::vector<UsefulEmission>& samples) {
  Vec3f upper = lower_ = samples.front().p;
  for (const UsefulEmission& sample : samples)
    for (int k = 0; k < 3; ++k) {
      lower_[k] = std::min(lower_[k], sample.p[k]);
      upper[k] = std::max(upper[k], sample.p[k]);
    }
  cell_ = std::max(max_component(upper - lower_) / cells_along, 1e-30f);
  std::size_t count = 1;
  for (int k = 0; k < 3; ++k) {
    const auto along = static_cast<std::uint32_t>((upper[k] - lower_[k]) / cell_) + 1;
    cells_[static_cast<std::size_t>(k)] = along;
    count *= along;
  }
  row_of_cell_.assign(count, no_guide);
}

std::vector<double> EmissionGuide::bin_weights(const std::vector<UsefulEmission>& samples) {
  std::vector<double> weights;
  const auto row_of = [&](std::size_t cell) {
    std::uint32_t& row = row_of_cell_[cell];
    if (row == no_guide) {
      row = static_cast<std::uint32_t>(weights.size() / guide_bins);
      weights.resize(weights.size() + guide_bins);
    }
    return std::size_t{row} * guide_bins;
  };
  for (const UsefulEmission& sample : samples) {
    const auto along = [&](int k) {
      return around(double{sample.p[k] - lower_[k]} / double{cell_}, cells_[static_cast<std::size_t>(k)]);
    };
    for (const Share& x : along(0))
      for (const Share& y : along(1))
        for (const Share& z : along(2)) {
          const double weight = x.weight * y.weight * z.weight * double{sample.flux};
          if (!(weight > 0)) continue;
          const std::size_t row = row_of((z.at * cells_[1] + y.at) * cells_[0] + x.at);
          spread(Vec3d(sample.w), [&](std::size_t bin, double part) { weights[row + bin] += weight * part; });
        }
  }
  return weights;
}

EmissionGuideTable EmissionGuide::table() const {
  if (cumulative_.empty()) return {};
  return {row_of_cell_.data(),
          cumulative_.data(),
          {lower_.x, lower_.y, lower_.z},
          1 / cell_,
          {cells_[0], cells_[1], cells_[2]}};
}

}  // namespace castray
