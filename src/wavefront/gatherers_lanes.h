#pragma once

#include "geometry/bvh_shaft_lanes.h"
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

/// The bounds of the points of some entries; without any the box has no extent and is at the origin.
template <int vectors>
CASTRAY_INLINE Box bounds_of(const Vertices& x, int first) {
  const float* axes[3] = {x.p.x, x.p.y, x.p.z};
  Box box{};
  Mask valid[vectors];
  uint32_t found = 0;
  for (int i = 0; i < vectors; ++i) {
    valid[i] = length_squared(load(x.normal, first + i * width)) > Float(0.f);
    found |= bits(valid[i]);
  }
  if (!found) return box;
  for (int axis = 0; axis < 3; ++axis) {
    Float low(__builtin_inff()), high(-__builtin_inff());
    for (int i = 0; i < vectors; ++i) {
      const Float p = load(axes[axis] + first + i * width);
      low = select(valid[i], min(low, p), low);
      high = select(valid[i], max(high, p), high);
    }
    float l = lane(low, 0), h = lane(high, 0);
    for (int k = 1; k < width; ++k) {
      l = lane(low, k) < l ? lane(low, k) : l;
      h = lane(high, k) > h ? lane(high, k) : h;
    }
    box.center[axis] = 0.5f * (l + h);
    box.half[axis] = 0.5f * (h - l) * (1 + 0x1p-20f) + 0x1p-24f;
  }
  return box;
}

/// `in_parts`: whether the parts' bounds are wanted too.
CASTRAY_INLINE void bound_tile(const Vertices& x, int first, bool in_parts, TileBoxes& boxes) {
  boxes.all = bounds_of<tile_vectors>(x, first);
  if (!in_parts) return;
  for (int i = 0; i < tile_parts; ++i) boxes.part[i] = bounds_of<part_vectors>(x, first + i * part_pixels);
}

}  // namespace castray::CASTRAY_ISA
