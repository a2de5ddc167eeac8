#pragma once

#include "geometry/shaft_lanes.h"
#include "wavefront/wave_lanes.h"

// The points of a tile, which gather light from points that send it.

namespace castray::CASTRAY_ISA {

inline constexpr int tile_vectors = tile_pixels / width;

/// A tile's points are also bounded in parts, the same for every width.
inline constexpr int tile_parts = 4, part_pixels = tile_pixels / tile_parts,
                     part_vectors = part_pixels / width;

/// The bounds of a tile's points, and of each 16 of them.
struct TileBoxes {
  Box all, part[tile_parts];
};

/// The points of one tile that gather: entries first to first + 63 of the camera's vertices.
struct Gatherers {
  const Vertices& x;
  int first;
  const TileBoxes& boxes;
  ShaftBudget budget{};
};

/// The sum of 64 values in an order that does not depend on the width: 16 strided sums, then halves onto
/// halves.
CASTRAY_INLINE float ordered_sum(const Float (&value)[tile_vectors]) {
  constexpr int stride = 16 / width;
  alignas(64) float sum[16];
  for (int s = 0; s < stride; ++s) {
    Float strided = value[s];
    for (int i = s + stride; i < tile_vectors; i += stride) strided += value[i];
    store(sum + s * width, strided);
  }
  for (int half = 8; half > 0; half /= 2)
    for (int i = 0; i < half; ++i) sum[i] += sum[i + half];
  return sum[0];
}

/// The bounds of a tile's points. `in_parts`: those of its parts are wanted too.
void bound_tile(const Vertices& x, int first, bool in_parts, TileBoxes& boxes);

}  // namespace castray::CASTRAY_ISA
