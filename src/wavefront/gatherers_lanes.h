#pragma once

#include "geometry/shaft_lanes.h"
#include "wavefront/wave_lanes.h"

// The camera vertices of a tile, which gather light from senders: light points and ends of suffixes.

namespace castray::CASTRAY_ISA {

inline constexpr int tile_vectors = tile_pixels / width;

/// A tile's points also have bounds in four parts of 16 pixels, whatever the width.
inline constexpr int tile_parts = 4, part_pixels = tile_pixels / tile_parts,
                     part_vectors = part_pixels / width;

/// Bounds of a tile's points, of its parts, and of groups of points that lie near each other.
struct TileBoxes {
  Box all, part[tile_parts];
  /// One group of all points; or two, which a gap parts: then the box of both is mostly empty, and what lies
  /// between a sender and the gap is in nobody's way.
  int groups;
  uint64_t pixels[2];  ///< of the groups
  Box group[2];
  float facing;  ///< see Geometry::make_shaft, for senders that some point of the tile is known to see
  bool empty;    ///< no point of the tile is on a surface
};

/// The points of one tile: entries first to first + 63 of the camera's vertices.
struct Gatherers {
  const Vertices& x;
  int first;
  const TileBoxes& boxes;
  ShaftBudget budget[2]{};  ///< by group
};

/// Whether a tile's points, seen from the camera at once, show more fronts (1) or backs (-1).
float side_seen(const Vertices& x, int first);

/// The lanes of vector i of a tile, of a bit for each of its pixels.
CASTRAY_INLINE Mask lanes_of(uint64_t pixels, int i) {
  return mask_of_bits((uint32_t)(pixels >> (i * width)) & (uint32_t)((1ull << width) - 1));
}

/// Sum of 64 values, in an order that does not depend on the width: 16 strided sums, which are then added
/// pairwise.
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

/// Bounds of a tile's points; with `in_parts` also those of its parts and groups.
void bound_tile(const Vertices& x, int first, bool in_parts, TileBoxes& boxes);

}  // namespace castray::CASTRAY_ISA
