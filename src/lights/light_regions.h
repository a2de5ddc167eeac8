#pragma once

#include <cstdint>
#include <vector>

#include "castray/vec.h"
#include "lights/light_records.h"

namespace castray {

/// What was found out at one place about the nodes of a light tree's cut.
struct LightTrial {
  Vec3f place;  ///< light_front in front of a surface
  float potential[most_light_cut] =
      {};  ///< of each node: irradiance that it would bring if nothing were between
  std::uint32_t tested = 0,
                seen = 0;  ///< a bit for each node: whether a point of it was looked for, and seen
};

/// Regions of space in which different lights are seen, learned from trials: a decision tree (Breiman et al.
/// 1984) whose planes part places from which nodes of the cut are seen from those from which they are not.
class LightRegionTable {
 public:
  LightRegionTable() = default;

  /// `power_shares`: of each node of the cut. A function of the trials and their order alone. One trial in
  /// four is kept to judge the table by.
  LightRegionTable(const std::vector<LightTrial>& trials, const std::vector<double>& power_shares);

  std::size_t regions() const { return seen_.size() / most_light_cut; }
  std::size_t region_at(const Vec3f& place) const;

  /// The mean square of a light sample's contribution without this table over that with it, at the trials
  /// kept for this: more than 1 where the table pays. Relative to each place's irradiance, but that dark
  /// places count less. 1 if no light is seen.
  double gain() const { return gain_; }

  /// Points into this; the number of primitives' nodes is left open.
  LightRegions view() const;

 private:
  class Grower;
  double judge(const std::vector<const LightTrial*>& trials) const;

  std::vector<RegionNode> tree_;
  std::vector<float> seen_, density_, inverse_power_;
  double gain_ = 1;
};

}  // namespace castray
