#pragma once

#include "wavefront/sequence_keys_lanes.h"

// Tiles with ragged edges: straight edges between tiles whose errors differ can be seen.

namespace castray::CASTRAY_ISA {

/// Mirrors coordinate `at` across the nearer edge of its tile, by chance: half of the pixels next to an edge,
/// fewer and fewer further in. Both pixels of a pair do the same, so that each pixel is in one tile.
CASTRAY_INLINE Uint swap_across_edge(uint32_t key, Uint at, Uint along) {
  const Uint place = at & (tile_size - 1u), half(tile_size / 2u);
  const Mask low = place < half;
  const Uint steps = select(low, place, Uint(tile_size - 1u) - place);
  const Uint edge = select(low, at - place, at - place + Uint(tile_size));
  const Uint mirrored = select(low, edge - steps - 1u, edge + steps);
  const Float chance = Float(0.5f) - (to_float(steps) + Float(0.5f)) * Float(1.f / tile_size);
  const Uint dice = hash_combine(hash_combine(Uint(key), edge + steps), along);
  return select(to_float(dice >> 8) * Float(0x1p-24f) < chance, mirrored, at);
}

/// Where two tiles meet along a strip of four pixels: in two of its rows one tile reaches into the other, in
/// the two beside them the other into the one, so that most neighbours stay in one tile.
struct Seam {
  int reach;      ///< in pixels
  uint32_t side;  ///< the bit `half_strip` of the rows in which the tile before the edge reaches further
};
constexpr int strip_side = tile_size / 2, half_strip = strip_side / 2;

/// How far from a tile's edge no pixel of a strip sees an edge of a surface, `reach` at most. `kinds`: of the
/// strip's first pixel beyond the tile's edge.
CASTRAY_INLINE int reach_on_surface(const uint8_t* kinds, int step_across, int step_along, int reach) {
  for (int steps = 0; steps < reach; ++steps)
    for (int i = 0; i < strip_side; ++i) {
      const uint8_t* row = kinds + i * step_along;
      if (row[steps * step_across] || row[-(steps + 1) * step_across]) return steps;
    }
  return reach;
}

/// That of a tile of the job at its edge `edge` across an axis (0: x, 1: y), along from `along` on; both as
/// from the tile's first pixel. It reaches up to 4 pixels in a first sample, so that the edge is in all
/// places alike, half as far in the next, but not past an edge of a surface: paths are shared best on one
/// surface.
CASTRAY_INLINE Seam seam_at(const Context& c, uint32_t key, const TilePlace& tile, int axis, int edge,
                            int along) {
  const EdgeTable& table = c.scene.edges;
  const int origin[2] = {tile.grid_x * tile_size, tile.grid_y * tile_size};
  const int pixel[2] = {tile.x - table.x0, tile.y - table.y0};
  const int step[2] = {1, table.width};
  const Uint across((uint32_t)(origin[axis] + edge)), from((uint32_t)(origin[1 - axis] + along));
  const uint32_t dice = lane(hash_combine(hash_combine(Uint(key + (uint32_t)axis), across), from), 0);
  const uint32_t most = (uint32_t)ragged_reach >> c.job.sample;
  const int reach = (int)((most * (dice >> 16) + 0x8000u) >> 16);
  const uint8_t* kinds =
      table.kinds + (pixel[axis] + edge) * step[axis] + (pixel[1 - axis] + along) * step[1 - axis];
  return {reach_on_surface(kinds, step[axis], step[1 - axis], reach), dice & half_strip};
}

/// Places the pixels of a tile of the job with seams in the place of its edges. Those across x come first;
/// those across y apply to where these put the pixels. Two tiles exchange pixels at a seam, so that each
/// pixel is in one tile.
CASTRAY_INLINE void place_in_strips(const Context& c, uint32_t key, int tile, TileResult& result) {
  constexpr int strips = (tile_size + 2 * ragged_reach) / strip_side;
  const TilePlace place = place_of(c.job, tile);
  Seam seams[2][2][strips];  // by axis, edge and strip
  for (int axis = 0; axis < 2; ++axis)
    for (int high = 0; high < 2; ++high)
      for (int s = 0; s < strips; ++s)
        seams[axis][high][s] = seam_at(c, key, place, axis, high * tile_size, s * strip_side - ragged_reach);
  for (int i = 0; i < tile_pixels; ++i) {
    int p[2] = {i % tile_size, i / tile_size};
    for (int axis = 0; axis < 2; ++axis) {
      int &across = p[axis], &along = p[1 - axis];
      const bool high = across >= tile_size / 2;
      const int steps = high ? tile_size - 1 - across : across;
      const Seam& seam = seams[axis][high][(along + ragged_reach) / strip_side];
      const bool reaches = high == (((uint32_t)along & half_strip) == seam.side);
      if (steps >= seam.reach || !reaches) continue;
      across = high ? tile_size + steps : -1 - steps;
      along ^= half_strip;
    }
    result.x[tile * tile_pixels + i] = (uint32_t)(place.x + p[0]);
    result.y[tile * tile_pixels + i] = (uint32_t)(place.y + p[1]);
  }
}

}  // namespace castray::CASTRAY_ISA
