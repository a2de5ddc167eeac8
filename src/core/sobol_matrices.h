#pragma once

#include <cstdint>

#include "core/contract.h"

namespace castray {

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

constexpr std::uint32_t reverse_bits(std::uint32_t v) {
  v = __builtin_bswap32(v);
  v = ((v & 0xf0f0f0f0u) >> 4) | ((v & 0x0f0f0f0fu) << 4);
  v = ((v & 0xccccccccu) >> 2) | ((v & 0x33333333u) << 2);
  return ((v & 0xaaaaaaaau) >> 1) | ((v & 0x55555555u) << 1);
}

}  // namespace castray
