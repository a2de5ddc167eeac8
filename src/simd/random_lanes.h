#pragma once

#include "core/contract.h"
#include "core/sobol_matrices.h"
#include "simd/lanes.h"

// core/sequences.h in lanes: the same numbers, bit for bit.

namespace castray::CASTRAY_ISA {

/// Which numbers a lane draws.
struct Sequence {
  Uint key;    ///< pixel_key, with the epoch of the sample folded in
  Uint index;  ///< sample index within its epoch
};

CASTRAY_INLINE Float to_unit(Uint v) { return to_float(v >> 8) * 0x1p-24f; }

/// What each group of four index bits contributes to the dimensions 1 to 3, digits reversed (first digit in
/// bit 0). Groups are numbered from the low bits of the index; within one, bits are read reversed.
struct SobolNibbles {
  uint32_t entry[3][index_bits / 4][16];
};
constexpr SobolNibbles make_nibbles() {
  constexpr SobolMatrices matrices = make_matrices();
  SobolNibbles nibbles{};
  for (int d = 0; d < 3; ++d)
    for (int group = 0; group < index_bits / 4; ++group)
      for (uint32_t value = 0; value < 16; ++value)
        for (int bit = 0; bit < 4; ++bit)
          if ((value >> (3 - bit)) & 1u)
            nibbles.entry[d][group][value] ^= castray::reverse_bits(matrices.column[d][4 * group + bit]);
  return nibbles;
}
inline constexpr SobolNibbles sobol_nibbles = make_nibbles();

/// The first N numbers of sample_block(kind, key, sample, block).
template <int N>
struct Numbers {
  Float u[N];
};
template <int N>
CASTRAY_INLINE Numbers<N> draw(bool sobol, const Sequence& sequence, uint32_t block) {
  const Uint seed = hash_combine(sequence.key, Uint(block));
  Numbers<N> numbers;
  if (!sobol) {
    const Uint mixed = hash_combine(seed, sequence.index);
    for (int d = 0; d < N; ++d) numbers.u[d] = to_unit(hash32(dimension_seed(mixed, d)));
    return numbers;
  }
  const Uint reversed = owen_hash(reverse_bits(sequence.index), seed);
  for (int d = 0; d < N; ++d) {
    Uint x = reverse_bits(reversed);
    if (d > 0) {
      x = Uint(0u);
      for (int group = 0; group < index_bits / 4; ++group)
        x = x ^ lookup16(sobol_nibbles.entry[d - 1][group], (reversed >> (28 - 4 * group)) & 15u);
    }
    numbers.u[d] = to_unit(reverse_bits(owen_hash(x, dimension_seed(seed, d))));
  }
  return numbers;
}

}  // namespace castray::CASTRAY_ISA
