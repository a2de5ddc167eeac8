#pragma once

#include <algorithm>
#include <cstdint>

#include "castray/film.h"
#include "core/sequences.h"
#include "plan/sample_map.h"
#include "wavefront/kernel_api.h"

namespace castray {

static_assert(tile_size == tile_side && ragged_reach == tile_reach);  // films take the tiles of kernels

/// The tiles that cover a window for one sample. Where paths are shared the grid is shifted anew for each
/// sample, by Sobol's points: each 8 samples from a multiple of 8 on have their edges in 8 different columns
/// and rows, and each 64 have all shifts, so that edges seldom add up.
struct TileGrid {
  int shift_x = 0, shift_y = 0;  ///< of the grid, to the left and up, in pixels
  int reach;                     ///< over a tile's edges, in pixels
  int x0, y0, x1, y1;            ///< tiles

  /// Grids of two takes of a sample lie half a tile apart.
  TileGrid(const Window& window, const KernelOptions& options, std::uint64_t sample, int take = 0) {
    if (options.suffixes > 0) {
      const auto u = sample_block(SamplerKind::sobol, hash_combine(options.seed, 0x5b1f7u), sample, 0);
      const auto shift = [take](float from) {
        return (static_cast<int>(from * tile_size) + take * tile_size / 2) % tile_size;
      };
      shift_x = shift(u[0]);
      shift_y = shift(u[1]);
    }
    reach = sample < options.ragged ? ragged_reach : 0;
    const auto tile_of = [](int pixel) {
      return (pixel + tile_size) / tile_size - 1;
    };  // pixel >= -tile_size
    x0 = tile_of(window.x0 + shift_x - reach);
    y0 = tile_of(window.y0 + shift_y - reach);
    x1 = tile_of(window.x1 - 1 + shift_x + reach) + 1;
    y1 = tile_of(window.y1 - 1 + shift_y + reach) + 1;
  }

  /// The first tiles of row y, from x on and before `end`, of which pixels want the sample: none, if the tile
  /// at x has none.
  TileJob job(int x, int end, int y, std::uint64_t sample, const SampleMap& map) const {
    const int left = x * tile_size - shift_x, top = y * tile_size - shift_y;
    const auto wanted = [&](int tile) {
      const int at = left + tile * tile_size;
      return map.wants_any(at - reach, top - reach, at + tile_size + reach, top + tile_size + reach, sample);
    };
    int tiles = 0;
    while (tiles < std::min(max_tiles, end - x) && wanted(tiles)) ++tiles;
    return {left, top, x, y, tiles, sample};
  }
};

}  // namespace castray
