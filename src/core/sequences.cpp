#include "core/sequences.h"

#include "core/sobol_matrices.h"

namespace castray {

namespace {

/// What each byte of the reversed index contributes to dimensions 1 to 3, bits reversed too: the matrices'
/// columns, added up beforehand. Three look-ups instead of twenty unpredictable branches.
struct SobolBytes {
  std::uint32_t reversed[3][3][256];  ///< [byte, from the top][dimension - 1][value]
};

constexpr SobolBytes make_bytes() {
  constexpr SobolMatrices matrices = make_matrices();
  SobolBytes bytes{};
  for (int j = 0; j < index_bits; ++j)
    for (unsigned value = 0; value < 256; ++value)
      if ((value >> (7 - j % 8)) & 1u)
        for (int d = 0; d < 3; ++d) bytes.reversed[j / 8][d][value] ^= reverse_bits(matrices.column[d][j]);
  return bytes;
}

constexpr SobolBytes sobol = make_bytes();

constexpr float to_unit(std::uint32_t v) { return static_cast<float>(v >> 8) * 0x1p-24f; }

}  // namespace

std::array<float, 4> sample_block(SamplerKind kind, std::uint32_t key, std::uint64_t sample,
                                  std::uint32_t block) {
  const auto epoch = static_cast<std::uint32_t>(sample >> index_bits);
  if (epoch) key = hash_combine(key, ~epoch);
  const std::uint32_t index = static_cast<std::uint32_t>(sample) & ((1u << index_bits) - 1);
  const std::uint32_t seed = hash_combine(key, block);
  std::array<float, 4> u;
  if (kind == SamplerKind::independent) {
    const std::uint32_t mixed = hash_combine(seed, index);
    for (std::uint32_t d = 0; d < 4; ++d) u[d] = to_unit(hash32(dimension_seed(mixed, d)));
    return u;
  }
  const std::uint32_t reversed = owen_hash(reverse_bits(index), seed);  // of the shuffled index
  const std::uint32_t byte[3] = {reversed >> 24, (reversed >> 16) & 255u, (reversed >> 8) & 255u};
  u[0] = to_unit(reverse_bits(owen_hash(reverse_bits(reversed), dimension_seed(seed, 0))));
  for (std::uint32_t d = 0; d < 3; ++d) {
    const std::uint32_t x =
        sobol.reversed[0][d][byte[0]] ^ sobol.reversed[1][d][byte[1]] ^ sobol.reversed[2][d][byte[2]];
    u[d + 1] = to_unit(reverse_bits(owen_hash(x, dimension_seed(seed, d + 1))));
  }
  return u;
}

std::uint32_t pixel_key(int x, int y, std::uint64_t seed) {
  std::uint32_t h = hash_combine(static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32));
  h = hash_combine(h, static_cast<std::uint32_t>(x));
  return hash_combine(h, static_cast<std::uint32_t>(y));
}

}  // namespace castray
