#pragma once

#include <array>
#include <cstdint>

#include "castray/render.h"

namespace castray {

/// Random numbers without state: four of them for (pixel key, sample index, block). Blocks are numbered by
/// use: block 0 is the camera's, then two for each path vertex (see `PathBlocks`). The four numbers of a
/// block are stratified together over sample indices; different blocks are independent.
///
/// `sobol` is the first four dimensions of Sobol's sequence, its index shuffled and its digits scrambled by
/// nested uniform scrambles (Owen 1995) made by hashing (Laine and Karras 2011, section 3; constants of
/// Vegdahl as used by pbrt-v4), a new scramble for each block (padding: Kollig and Keller 2002). After 2^20
/// samples the scramble is drawn anew. Values are multiples of 2^-24 in [0,1).
std::array<float, 4> sample_block(SamplerKind kind, std::uint32_t key, std::uint64_t sample,
                                  std::uint32_t block);

/// The key of pixel (x,y) of the full image under a seed.
std::uint32_t pixel_key(int x, int y, std::uint64_t seed);

/// Which block serves which decision.
struct PathBlocks {
  static constexpr std::uint32_t camera = 0;  ///< jitter (2), light point of the first vertex (2)
  /// At vertex k >= 0 (0 is the camera's hit): direction (2), light point of vertex k + 1 (2).
  static constexpr std::uint32_t direction(std::uint32_t vertex) { return 1 + 2 * vertex; }
  /// At vertex k: roulette, lobe choice, light choice, spare.
  static constexpr std::uint32_t choice(std::uint32_t vertex) { return 2 + 2 * vertex; }
};

/// A good 32-bit finaliser (low-bias constants of Wellons' search, "lowbias32").
constexpr std::uint32_t hash32(std::uint32_t x) {
  x ^= x >> 16;
  x *= 0x7feb352du;
  x ^= x >> 15;
  x *= 0x846ca68bu;
  x ^= x >> 16;
  return x;
}

constexpr std::uint32_t hash_combine(std::uint32_t a, std::uint32_t b) {
  return hash32(a ^ (b * 0x9e3779b9u + 0x7f4a7c15u));
}

/// The seed of dimension d < 4 of a block's scramble, from the block's seed.
constexpr std::uint32_t dimension_seed(std::uint32_t seed, std::uint32_t d) {
  constexpr std::uint32_t factor[4] = {0x9e3779b1u, 0x85ebca77u, 0xc2b2ae3du, 0x27d4eb2fu};
  const std::uint32_t v = seed * factor[d];
  return v ^ (v >> 16);
}

/// Nested uniform scramble in which every bit depends on the lower ones.
constexpr std::uint32_t owen_hash(std::uint32_t v, std::uint32_t seed) {
  v ^= v * 0x3d20adeau;
  v += seed;
  v *= (seed >> 16) | 1u;
  v ^= v * 0x05526c56u;
  v ^= v * 0x53a22864u;
  return v;
}

}  // namespace castray
