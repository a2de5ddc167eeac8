#pragma once

#include <array>
#include <cstdint>

#include "castray/render_options.h"
#include "core/contract.h"

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

}  // namespace castray
