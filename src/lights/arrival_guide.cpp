#include "lights/arrival_guide.h"

#include <algorithm>

#include "lights/direction_bins.h"

namespace castray {

namespace {

constexpr std::size_t least_samples = 64;  // of a leaf
constexpr double of_larger_box = 0.5;      // directions that a leaf's samples have missed are not to be rare
constexpr int most_depth = 24;

/// The axis along which samples lie farthest apart.
int longest_axis(std::span<const UsefulEmission> samples) {
  Vec3f lower = samples.front().p, upper = lower;
  for (const UsefulEmission& sample : samples)
    for (int k = 0; k < 3; ++k) {
      lower[k] = std::min(lower[k], sample.p[k]);
      upper[k] = std::max(upper[k], sample.p[k]);
    }
  const Vec3f size = upper - lower;
  return size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
}

/// What samples say of directions, and what is known of a larger box around them.
std::vector<double> row_of(std::span<const UsefulEmission> samples, const std::vector<double>& around) {
  std::vector<double> row(guide_bins);
  double sum = 0;
  for (const UsefulEmission& sample : samples) {
    spread(Vec3d(sample.w), double{sample.flux}, row.data());
    sum += double{sample.flux};
  }
  for (std::size_t bin = 0; bin < row.size(); ++bin)
    row[bin] =
        around.empty() ? row[bin] / sum : row[bin] / sum * (1 - of_larger_box) + around[bin] * of_larger_box;
  return row;
}

}  // namespace

ArrivalGuide::ArrivalGuide(std::vector<UsefulEmission> samples) {
  std::erase_if(samples, [](const UsefulEmission& sample) { return !(sample.flux > 0); });
  if (samples.size() < least_samples) return;
  tree_.emplace_back();
  grow(0, samples, {}, 0);
  cumulative_ = cumulative_of(weights_);
  weights_ = {};
}

void ArrivalGuide::grow(std::size_t node, std::span<UsefulEmission> samples,
                        const std::vector<double>& around, int depth) {
  const std::vector<double> row = row_of(samples, around);
  if (samples.size() >= 2 * least_samples && depth < most_depth) {
    const int axis = longest_axis(samples);
    const auto middle = samples.begin() + static_cast<std::ptrdiff_t>(samples.size() / 2);
    std::nth_element(samples.begin(), middle, samples.end(),
                     [&](const auto& a, const auto& b) { return a.p[axis] < b.p[axis]; });
    const float plane = middle->p[axis];
    const auto first = std::stable_partition(samples.begin(), samples.end(),
                                             [&](const auto& sample) { return sample.p[axis] < plane; });
    if (first != samples.begin()) {
      const std::size_t children = tree_.size();
      tree_.resize(children + 2);
      tree_[node] = {plane, static_cast<std::uint32_t>(axis) | static_cast<std::uint32_t>(children) << 2};
      grow(children, {samples.begin(), first}, row, depth + 1);
      grow(children + 1, {first, samples.end()}, row, depth + 1);
      return;
    }
  }
  const std::size_t leaf = weights_.size() / guide_bins;
  tree_[node] = {0, region_leaf | static_cast<std::uint32_t>(leaf) << 2};
  weights_.insert(weights_.end(), row.begin(), row.end());
}

ArrivalGuideTable ArrivalGuide::table() const {
  if (tree_.empty()) return {};
  return {tree_.data(), cumulative_.data()};
}

}  // namespace castray
