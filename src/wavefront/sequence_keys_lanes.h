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

CASTRAY_INLINE uint32_t hash_once(uint32_t a, uint32_t b) { return lane(hash_combine(Uint(a), Uint(b)), 0); }

CASTRAY_INLINE TilePlace place_of(const TileJob& job, int tile) {
  if (job.places) return job.places[tile];
  return {job.x + tile * tile_size, job.y, job.grid_x + tile, job.grid_y};
}

/// The sample of a tile in its random sequences. Repeats of a tile count them up, which spreads their numbers
/// better than sequences of their own would.
CASTRAY_INLINE uint64_t sample_of(const Context& c, const TilePlace& place) {
  return c.job.sample * place.repeats + place.repeat;
}

/// The key of such a sequence, of a pixel or a tile, each sample of which takes `items` of its points.
/// Samples in which the tile is repeated have another.
CASTRAY_INLINE Uint key_in(const Context& c, const TilePlace& place, Uint key, uint32_t items = 1) {
  const Uint own = place.repeats > 1 ? hash_combine(key, Uint(0x2e9ea7u)) : key;
  return with_epoch(own, sample_of(c, place) * items);
}

/// Items of one kind that the pixels of a tile share in a sample, at most: a sequence ends before these would
/// take its points a second time.
constexpr uint32_t most_items = tile_pixels;

/// Which numbers a tile's shared items take: those of a sample under a key.
struct TileSequence {
  uint32_t key;
  uint64_t sample;
};
CASTRAY_INLINE TileSequence tile_sequence(const Context& c, int tile) {
  const TilePlace place = place_of(c.job, tile);
  const uint32_t key = hash_once(hash_once(hash_once(c.options.seed, 0x7411u), (uint32_t)place.grid_x),
                                 (uint32_t)place.grid_y);
  return {lane(key_in(c, place, Uint(key), most_items), 0), sample_of(c, place)};
}

/// The world of a sample (see PartialTriangles), one for all its pixels: in one world all visibilities are
/// fixed, so that the balance heuristic over shared paths holds in it as in any scene, and so on average.
CASTRAY_INLINE uint32_t world_key(const KernelOptions& options, uint64_t sample) {
  return hash_once(hash_once(hash_once(options.seed, 0x3057u), (uint32_t)sample), (uint32_t)(sample >> 32));
}

/// Sequence indices of `count` (a power of two) items that a tile shares. Each sample takes the next
/// `count` indices, in a random order of its own.
CASTRAY_INLINE Uint tile_index(const TileSequence& tile, Uint item, uint32_t count) {
  const uint32_t order = hash_once(tile.key, (uint32_t)tile.sample);
  const Uint low(count - 1);
  Uint v = (item ^ Uint(order)) * ((order >> 8) | 1u);
  v = (v ^ ((v & low) >> 2)) * ((order >> 16) | 1u);
  return (((v + (order >> 24)) & low) + Uint((uint32_t)tile.sample * count)) & ((1u << index_bits) - 1);
}

}  // namespace castray::CASTRAY_ISA
