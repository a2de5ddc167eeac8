#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "castray/vec.h"
#include "lights/light_records.h"

namespace castray {

/// What a light emits that a surface which focuses is the first to scatter.
struct UsefulEmission {
  Vec3f p;  ///< point of the light
  Vec3f w;  ///< unit vector along which it leaves
  float flux;
};

/// In which directions lights emit what mirrors and glass focus: for each cell of a grid over the places
/// where it starts a histogram over directions, from samples (after Jensen 1995, who learns where light
/// arrives).
class EmissionGuide {
 public:
  EmissionGuide() = default;
  explicit EmissionGuide(const std::vector<UsefulEmission>& samples);

  /// Empty without samples. It points into this object.
  EmissionGuideTable table() const;

 private:
  void lay_grid(const std::vector<UsefulEmission>& samples);
  /// A row of guide_bins weights of directions for each cell that has any; says which in row_of_cell_.
  std::vector<double> bin_weights(const std::vector<UsefulEmission>& samples);

  Vec3f lower_;
  float cell_ = 0;  ///< side of a cell
  std::array<std::uint32_t, 3> cells_{};
  std::vector<std::uint32_t> row_of_cell_;
  std::vector<float> cumulative_;
};

}  // namespace castray
