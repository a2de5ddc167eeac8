#pragma once

#include <cstdint>
#include <vector>

#include "castray/scene.h"
#include "lights/light_records.h"

namespace castray {

/// A part of an emitting triangle that is like it: the corner (b1,b2) by the triangle's barycentrics, and the
/// length of its sides there. Below 0 it lies upside down.
struct EmissionCell {
  double b1 = 0, b2 = 0, step = 1;
  Vec3d emission;  ///< radiance in proportion to which light sampling chooses it
};

/// What light sampling takes emitters for. Triangles of which an image says what they emit are cut into like
/// parts, and each is chosen by what it emits: seven eighths of its probability, the rest by the material's
/// mean, so that nothing is chosen too seldom, whatever the image has between the places that are looked at.
class EmissionCells {
 public:
  EmissionCells() = default;
  explicit EmissionCells(const Scene& scene);

  /// The parts of a triangle of which this material, on one of its sides, emits; itself where no image says
  /// what it emits, or where both sides might differ.
  std::vector<EmissionCell> of(std::uint32_t triangle, std::uint16_t material) const;

  /// The density of light samples at a point of an emitting triangle, over that of its material by its mean.
  double share(std::uint32_t triangle, double b1, double b2) const;

  /// Points into this.
  CellTable table() const;

 private:
  void add(const Scene& scene, std::uint32_t triangle, int looks);
  /// The number of a cell that holds a point, in its triangle.
  std::size_t cell_at(double b1, double b2) const;
  bool has_cells(std::uint32_t triangle) const {
    return triangle < first_.size() && first_[triangle] != no_cells;
  }

  const Scene* scene_ = nullptr;
  std::vector<Vec3d> means_;          ///< by material
  int steps_ = 1;                     ///< of the cells along an edge
  std::vector<std::uint32_t> first_;  ///< by triangle, into `emission_`, or no_cells; empty: none has any
  std::vector<Vec3d> emission_;       ///< of 2 * steps^2 places of each triangle
  std::vector<float> shares_;         ///< likewise
};

}  // namespace castray
