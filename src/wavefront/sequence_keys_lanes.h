#pragma once

#include "simd/random_lanes.h"
#include "wavefront/context_lanes.h"

// Keys and indices into the random sequence, of pixels and of the items that a tile shares.

namespace castray::CASTRAY_ISA {

/// Folds the epoch of a sample index into a key (see sample_block).
CASTRAY_INLINE Uint with_epoch(Uint key, uint64_t sample) {
  const uint32_t epoch = (uint32_t)(sample >> index_bits);
  return epoch ? hash_combine(key, Uint(~epoch)) : key;
}

/// Folds the repeat of a tile's sample into a key.
CASTRAY_INLINE Uint with_repeat(Uint key, uint32_t repeat) {
  return repeat ? hash_combine(key, Uint(0x2e9ea7u + repeat)) : key;
}

CASTRAY_INLINE uint32_t hash_once(uint32_t a, uint32_t b) { return lane(hash_combine(Uint(a), Uint(b)), 0); }

CASTRAY_INLINE TilePlace place_of(const TileJob& job, int tile) {
  if (job.places) return job.places[tile];
  return {job.x + tile * tile_size, job.y, job.grid_x + tile, job.grid_y};
}

CASTRAY_INLINE uint32_t tile_key(const Context& c, int tile) {
  const TilePlace place = place_of(c.job, tile);
  const uint32_t key = hash_once(hash_once(hash_once(c.options.seed, 0x7411u), (uint32_t)place.grid_x),
                                 (uint32_t)place.grid_y);
  return lane(with_repeat(with_epoch(Uint(key), c.job.sample), place.repeat), 0);
}

/// The world of a sample (see PartialTriangles), one for all its pixels: in one world all visibilities are
/// fixed, so that the balance heuristic over shared paths holds in it as in any scene, and so on average.
CASTRAY_INLINE uint32_t world_key(const KernelOptions& options, uint64_t sample) {
  return hash_once(hash_once(hash_once(options.seed, 0x3057u), (uint32_t)sample), (uint32_t)(sample >> 32));
}

/// Sequence indices of `count` (a power of two) items that a tile shares. Each sample takes the next
/// `count` indices, in a random order of its own.
CASTRAY_INLINE Uint tile_index(uint32_t key, uint64_t sample, Uint item, uint32_t count) {
  const uint32_t order = hash_once(key, (uint32_t)sample);
  const Uint low(count - 1);
  Uint v = (item ^ Uint(order)) * ((order >> 8) | 1u);
  v = (v ^ ((v & low) >> 2)) * ((order >> 16) | 1u);
  return (((v + (order >> 24)) & low) + Uint((uint32_t)sample * count)) & ((1u << index_bits) - 1);
}

}  // namespace castray::CASTRAY_ISA
