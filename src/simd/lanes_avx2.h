#pragma once

#include "simd/lanes_vector_mask.h"

namespace castray::CASTRAY_ISA {

CASTRAY_INLINE uint32_t bits(Mask a) { return (uint32_t)_mm256_movemask_ps((__m256)a.m); }
CASTRAY_INLINE Float select(Mask m, Float a, Float b) {
  return (RawFloat)_mm256_blendv_ps((__m256)b.v, (__m256)a.v, (__m256)m.m);
}
CASTRAY_INLINE Uint select(Mask m, Uint a, Uint b) {
  return (RawUint)_mm256_blendv_epi8((__m256i)b.v, (__m256i)a.v, (__m256i)m.m);
}
CASTRAY_INLINE Float fma(Float a, Float b, Float c) {
  return (RawFloat)_mm256_fmadd_ps((__m256)a.v, (__m256)b.v, (__m256)c.v);
}
CASTRAY_INLINE Float sqrt(Float a) { return (RawFloat)_mm256_sqrt_ps((__m256)a.v); }
CASTRAY_INLINE Float min(Float a, Float b) { return (RawFloat)_mm256_min_ps((__m256)a.v, (__m256)b.v); }
CASTRAY_INLINE Float max(Float a, Float b) { return (RawFloat)_mm256_max_ps((__m256)a.v, (__m256)b.v); }
CASTRAY_INLINE Float gather(const float* base, Uint i) {
  return (RawFloat)_mm256_i32gather_ps(base, (__m256i)i.v, 4);
}
CASTRAY_INLINE Uint gather(const uint32_t* base, Uint i) {
  return (RawUint)_mm256_i32gather_epi32((const int*)base, (__m256i)i.v, 4);
}

/// The lanes set in `m`, packed to the front: a permutation built from the mask's bits.
CASTRAY_INLINE __m256i packing(Mask m) {
  const uint64_t spread = _pdep_u64(bits(m), 0x0101010101010101ull) * 0xff;
  return _mm256_cvtepu8_epi32(_mm_cvtsi64_si128((long long)_pext_u64(0x0706050403020100ull, spread)));
}
CASTRAY_INLINE void compress_store(float* p, Mask m, Float a) {
  _mm256_storeu_ps(p, _mm256_permutevar8x32_ps((__m256)a.v, packing(m)));
}
CASTRAY_INLINE void compress_store(uint32_t* p, Mask m, Uint a) {
  _mm256_storeu_si256((__m256i*)p, _mm256_permutevar8x32_epi32((__m256i)a.v, packing(m)));
}
/// table[i] for i < 16.
CASTRAY_INLINE Uint lookup16(const uint32_t* table, Uint i) {
  const __m256i low = _mm256_permutevar8x32_epi32(_mm256_loadu_si256((const __m256i*)table), (__m256i)i.v);
  const __m256i high =
      _mm256_permutevar8x32_epi32(_mm256_loadu_si256((const __m256i*)(table + 8)), (__m256i)i.v);
  return (RawUint)_mm256_blendv_ps((__m256)low, (__m256)high, (__m256)(i.v << 28));
}
/// The four bytes from `base` + i on, the first in the lowest bits.
CASTRAY_INLINE Uint gather_bytes(const uint8_t* base, Uint i) {
  return (RawUint)_mm256_i32gather_epi32((const int*)base, (__m256i)i.v, 1);
}
/// Bit i of the result is bit 31 - i of `a`.
CASTRAY_INLINE Uint reverse_bits(Uint a) {
  const __m256i low_nibbles = _mm256_set1_epi8(0x0f);
  const __m256i reversed =
      _mm256_broadcastsi128_si256(_mm_setr_epi8(0, 8, 4, 12, 2, 10, 6, 14, 1, 9, 5, 13, 3, 11, 7, 15));
  const __m256i swap =
      _mm256_broadcastsi128_si256(_mm_setr_epi8(3, 2, 1, 0, 7, 6, 5, 4, 11, 10, 9, 8, 15, 14, 13, 12));
  const __m256i low = _mm256_shuffle_epi8(reversed, _mm256_and_si256((__m256i)a.v, low_nibbles));
  const __m256i high = _mm256_shuffle_epi8(reversed, _mm256_and_si256((__m256i)(a.v >> 4), low_nibbles));
  return (RawUint)_mm256_shuffle_epi8((__m256i)((RawUint)low << 4 | (RawUint)high), swap);
}

}  // namespace castray::CASTRAY_ISA
