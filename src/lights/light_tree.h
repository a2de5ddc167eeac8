#pragma once

#include <vector>

#include "lights/light_records.h"

namespace castray {

/// A balanced binary tree over lights, by whose bounds one is chosen (lights/light_choice_lanes.h).
class LightTree {
 public:
  LightTree() = default;

  /// The lights are sorted so that neighbours in the list are neighbours in space. Built in parallel; does
  /// not depend on `threads`.
  LightTree(const std::vector<KernelLight>& lights, int threads);

  /// The nodes of one level, at most most_light_cut: every light is below, or is, just one of them.
  const std::vector<LightBounds>& cut() const { return cut_; }
  /// Inner nodes by their children, side by side.
  const std::vector<LightBounds>& pairs() const { return pairs_; }

 private:
  std::vector<LightBounds> cut_, pairs_;
};

}  // namespace castray
