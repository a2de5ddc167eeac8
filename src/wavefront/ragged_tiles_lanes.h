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

constexpr int strip_side = tile_size / 2, half_strip = strip_side / 2;
constexpr int strips_of_seam = (tile_size + 2 * ragged_reach) / strip_side,
              seams_of_tile = 2 * 2 * strips_of_seam;
static_assert(strips_of_seam == 4 && seams_of_tile % width == 0);

/// The seams of a tile, by axis (0: across x, 1: across y), edge and strip of four pixels. In two rows of a
/// strip one tile reaches into the other, in the two beside them the other into the one, so that most
/// neighbours stay in one tile.
struct Seams {
  uint32_t reach[seams_of_tile];  ///< in pixels
  uint32_t side[seams_of_tile];   ///< the bit `half_strip` of the rows in which the tile before the edge
                                  ///< reaches further
};

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

/// A random number of each. Two tiles find the same for the seam between them.
CASTRAY_INLINE void draw_seams(uint32_t key, const TilePlace& tile, uint32_t (&dice)[seams_of_tile]) {
  const Uint left((uint32_t)(tile.grid_x * tile_size)), top((uint32_t)(tile.grid_y * tile_size));
  for (int i = 0; i < seams_of_tile; i += width) {
    const Uint number = Uint((uint32_t)i) + lane_index();
    const Uint axis = number >> 3, high = (number >> 2) & 1u, strip = number & 3u;
    const Mask across_x = axis < Uint(1u);
    const Uint across = select(across_x, left, top) + high * Uint((uint32_t)tile_size);
    const Uint from =
        select(across_x, top, left) + strip * Uint((uint32_t)strip_side) - Uint((uint32_t)ragged_reach);
    store(dice + i, hash_combine(hash_combine(Uint(key) + axis, across), from));
  }
}

/// Whether any pixel that a tile's seams may move sees an edge.
CASTRAY_INLINE bool any_edge_around(const EdgeTable& table, const TilePlace& tile) {
  constexpr int side = tile_size + 2 * ragged_reach;
  const uint8_t* kinds =
      table.kinds + (tile.y - ragged_reach - table.y0) * table.width + (tile.x - ragged_reach - table.x0);
  uint64_t any = 0;
  for (int y = 0; y < side; ++y) {
    uint64_t row[side / 8];
    __builtin_memcpy(row, kinds + y * table.width, sizeof row);
    for (const uint64_t eight : row) any |= eight;
  }
  return any != 0;
}

/// They reach up to 4 pixels in a first sample, so that the edge is in all places alike, half as far in the
/// next, but not past an edge of a surface: paths are shared best on one surface.
CASTRAY_INLINE void find_seams(const Context& c, uint32_t key, const TilePlace& tile, Seams& seams) {
  const EdgeTable& table = c.scene.edges;
  const uint32_t most = (uint32_t)ragged_reach >> c.job.sample;
  const bool any_edge = any_edge_around(table, tile);
  const int pixel[2] = {tile.x - table.x0, tile.y - table.y0};
  const int step[2] = {1, table.width};
  uint32_t dice[seams_of_tile];
  draw_seams(key, tile, dice);
  for (int i = 0; i < seams_of_tile; ++i) {
    const int axis = i / (2 * strips_of_seam), high = i / strips_of_seam % 2, strip = i % strips_of_seam;
    int reach = (int)((most * (dice[i] >> 16) + 0x8000u) >> 16);
    if (any_edge) {
      const uint8_t* kinds = table.kinds + (pixel[axis] + high * tile_size) * step[axis] +
                             (pixel[1 - axis] + strip * strip_side - ragged_reach) * step[1 - axis];
      reach = reach_on_surface(kinds, step[axis], step[1 - axis], reach);
    }
    seams.reach[i] = (uint32_t)reach;
    seams.side[i] = dice[i] & half_strip;
  }
}

/// Places the pixels of a tile of the job with seams in the place of its edges. Those across x come first;
/// those across y apply to where these put the pixels. Two tiles exchange pixels at a seam, so that each
/// pixel is in one tile.
CASTRAY_INLINE void place_in_strips(const Context& c, uint32_t key, int tile, TileResult& result) {
  const TilePlace place = place_of(c.job, tile);
  Seams seams;
  find_seams(c, key, place, seams);
  for (int i = 0; i < tile_pixels; i += width) {
    const Uint entry = Uint((uint32_t)i) + lane_index();
    Uint p[2] = {entry & 7u, entry >> 3};
    for (uint32_t axis = 0; axis < 2; ++axis) {
      Uint &across = p[axis], &along = p[1 - axis];
      const Mask low = across < Uint(tile_size / 2u);
      const Uint steps = select(low, across, Uint(tile_size - 1u) - across);
      const Uint seam = Uint(axis * 2 * strips_of_seam) +
                        select(low, Uint(0u), Uint((uint32_t)strips_of_seam)) +
                        ((along + Uint((uint32_t)ragged_reach)) >> 2);
      const Mask before = (along & Uint((uint32_t)half_strip)) == gather(seams.side, seam);
      const Mask moves = (steps < gather(seams.reach, seam)) & ((low & ~before) | (~low & before));
      across = select(moves, select(low, Uint(~0u) - steps, Uint((uint32_t)tile_size) + steps), across);
      along = select(moves, along ^ Uint((uint32_t)half_strip), along);
    }
    store(result.x + tile * tile_pixels + i, Uint((uint32_t)place.x) + p[0]);
    store(result.y + tile * tile_pixels + i, Uint((uint32_t)place.y) + p[1]);
  }
}

}  // namespace castray::CASTRAY_ISA
