#pragma once

#include <cstdint>
#include <vector>

#include "castray/scene.h"

namespace castray {

/// Where an image says what of a triangle is there, most of its places are wholly there, or not at all, and
/// need no look at the image (after opacity micromaps, Gruen, Benthin, Woop 2020). So each such triangle has
/// a grid of cells over its barycentrics, which tell of all their points at once. Triangles of one material
/// and the same texture coordinates share a grid.
///
/// A point whose coverage is within 1e-6 of 1 is there.
class CoverageCells {
 public:
  explicit CoverageCells(const Scene& scene);

  /// A grid has side() x side() cells, rows of constant b2, a CoverageCell of two bits each, the lowest
  /// first. 0: there are no grids.
  std::uint32_t side() const { return side_; }
  const std::uint32_t* cells() const { return cells_.data(); }
  /// By triangle: where in `cells` its grid begins, or no_coverage_grid.
  const std::uint32_t* grids() const { return grids_.data(); }

 private:
  std::uint32_t side_ = 0;
  std::vector<std::uint32_t> cells_, grids_;
};

}  // namespace castray
