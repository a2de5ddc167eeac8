#include "core/sequences.h"

#include "core/sobol_matrices.h"

namespace castray {

namespace {

constexpr SobolMatrices sobol = make_matrices();

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
  std::uint32_t x[4] = {reversed, 0, 0, 0};
  for (int j = 0; j < index_bits; ++j)
    if ((reversed >> (31 - j)) & 1u)
      for (int d = 0; d < 3; ++d) x[d + 1] ^= sobol.column[d][j];
  for (std::uint32_t d = 0; d < 4; ++d)
    u[d] = to_unit(reverse_bits(owen_hash(reverse_bits(x[d]), dimension_seed(seed, d))));
  return u;
}

std::uint32_t pixel_key(int x, int y, std::uint64_t seed) {
  std::uint32_t h = hash_combine(static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32));
  h = hash_combine(h, static_cast<std::uint32_t>(x));
  return hash_combine(h, static_cast<std::uint32_t>(y));
}

}  // namespace castray
