#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lights/emission_guide.h"
#include "lights/light_records.h"

namespace castray {

/// From which directions surfaces get what mirrors and glass focus: a tree of boxes, each with as many
/// samples, and a histogram over directions for each box (after Jensen 1995, and Mueller, Gross and Novak
/// 2017, who part space so).
class ArrivalGuide {
 public:
  ArrivalGuide() = default;
  /// `samples`: where light arrives, and unit vectors to where it comes from. Their order is changed.
  explicit ArrivalGuide(std::vector<UsefulEmission> samples);

  /// Empty where there are too few samples to tell. It points into this object.
  ArrivalGuideTable table() const;

 private:
  void grow(std::size_t node, std::span<UsefulEmission> samples, const std::vector<double>& around,
            int depth);

  std::vector<RegionNode> tree_;
  std::vector<double> weights_;  ///< while it grows: guide_bins for each leaf
  std::vector<float> cumulative_;
};

}  // namespace castray
