#include "core/sequences.h"

namespace castray {

namespace {

constexpr int index_bits = 20;

/// Generator matrices of Sobol's dimensions 1 to 3 (Joe and Kuo 2008), from their primitive polynomials and
/// initial numbers; column j is what bit j of the index contributes. Bit 31 is the first digit after the
/// point.
struct SobolMatrices {
  std::uint32_t column[3][index_bits];
};

constexpr SobolMatrices make_matrices() {
  // degree, coefficients a_1..a_{s-1}, initial m_1..m_s
  constexpr int degree[3] = {1, 2, 3};
  constexpr unsigned coefficients[3] = {0, 1, 1};
  constexpr std::uint32_t initial[3][3] = {{1, 0, 0}, {1, 3, 0}, {1, 3, 1}};
  SobolMatrices matrices{};
  for (int d = 0; d < 3; ++d) {
    const int s = degree[d];
    for (int j = 0; j < index_bits; ++j) {
      std::uint32_t v = 0;
      if (j < s) {
        v = initial[d][j] << (31 - j);
      } else {
        v = matrices.column[d][j - s] ^ (matrices.column[d][j - s] >> s);
        for (int k = 1; k < s; ++k)
          if ((coefficients[d] >> (s - 1 - k)) & 1u) v ^= matrices.column[d][j - k];
      }
      matrices.column[d][j] = v;
    }
  }
  return matrices;
}

constexpr SobolMatrices sobol = make_matrices();

constexpr std::uint32_t reverse_bits(std::uint32_t v) {
  v = (v >> 16) | (v << 16);
  v = ((v & 0xff00ff00u) >> 8) | ((v & 0x00ff00ffu) << 8);
  v = ((v & 0xf0f0f0f0u) >> 4) | ((v & 0x0f0f0f0fu) << 4);
  v = ((v & 0xccccccccu) >> 2) | ((v & 0x33333333u) << 2);
  return ((v & 0xaaaaaaaau) >> 1) | ((v & 0x55555555u) << 1);
}

constexpr float to_unit(std::uint32_t v) { return static_cast<float>(v >> 8) * 0x1p-24f; }

}  // namespace

std::array<float, 4> sample_block(SamplerKind kind, std::uint32_t key, std::uint64_t sample,
                                  std::uint32_t block) {
  const auto low = static_cast<std::uint32_t>(sample);
  std::uint32_t seed = hash_combine(key, block);
  std::array<float, 4> u;
  if (kind == SamplerKind::independent) {
    seed = hash_combine(seed, low);
    if (sample >> 32) seed = hash_combine(seed, static_cast<std::uint32_t>(sample >> 32));
    for (std::uint32_t d = 0; d < 4; ++d) u[d] = to_unit(hash32(seed + d * 0x9e3779b9u));
    return u;
  }
  const auto epoch = static_cast<std::uint32_t>(sample >> index_bits);
  if (epoch) seed = hash_combine(seed, epoch);
  const std::uint32_t in_epoch = low & ((1u << index_bits) - 1);
  const std::uint32_t index =
      reverse_bits(owen_hash(reverse_bits(in_epoch), seed)) & ((1u << index_bits) - 1);
  std::uint32_t x[4] = {reverse_bits(index), 0, 0, 0};
  for (int j = 0; j < index_bits; ++j)
    if ((index >> j) & 1u)
      for (int d = 0; d < 3; ++d) x[d + 1] ^= sobol.column[d][j];
  for (std::uint32_t d = 0; d < 4; ++d) {
    const std::uint32_t scramble = hash32(seed + (d + 1) * 0x9e3779b9u);
    u[d] = to_unit(reverse_bits(owen_hash(reverse_bits(x[d]), scramble)));
  }
  return u;
}

std::uint32_t pixel_key(int x, int y, std::uint64_t seed) {
  std::uint32_t h = hash_combine(static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32));
  h = hash_combine(h, static_cast<std::uint32_t>(x));
  return hash_combine(h, static_cast<std::uint32_t>(y));
}

}  // namespace castray
