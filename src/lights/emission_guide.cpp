#include "lights/emission_guide.h"

#include <algorithm>

#include "lights/direction_bins.h"

namespace castray {

namespace {

constexpr float cells_along = 4;  // the longest side of where samples start

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
    for (const GridShare& x : along(0))
      for (const GridShare& y : along(1))
        for (const GridShare& z : along(2)) {
          const double weight = x.weight * y.weight * z.weight * double{sample.flux};
          if (!(weight > 0)) continue;
          const std::size_t row = row_of((z.at * cells_[1] + y.at) * cells_[0] + x.at);
          spread(Vec3d(sample.w), weight, &weights[row]);
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
