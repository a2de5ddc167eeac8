#pragma once

#include "simd/lane_types.h"

namespace castray::CASTRAY_ISA {

/// True or false in each lane: a bit each.
struct Mask {
  __mmask16 m;
  CASTRAY_INLINE explicit Mask(__mmask16 bits) : m(bits) {}
  CASTRAY_INLINE explicit Mask(bool all) : m(all ? __mmask16(0xffff) : __mmask16(0)) {}
  Mask() = default;
};
CASTRAY_INLINE Mask operator&(Mask a, Mask b) { return Mask((__mmask16)(a.m & b.m)); }
CASTRAY_INLINE Mask operator|(Mask a, Mask b) { return Mask((__mmask16)(a.m | b.m)); }
CASTRAY_INLINE Mask operator~(Mask a) { return Mask((__mmask16)~a.m); }
CASTRAY_INLINE uint32_t bits(Mask a) { return a.m; }
CASTRAY_INLINE Mask mask_of_bits(uint32_t b) { return Mask((__mmask16)b); }
CASTRAY_INLINE Mask operator<(Float a, Float b) {
  return Mask(_mm512_cmp_ps_mask((__m512)a.v, (__m512)b.v, _CMP_LT_OQ));
}
CASTRAY_INLINE Mask operator<=(Float a, Float b) {
  return Mask(_mm512_cmp_ps_mask((__m512)a.v, (__m512)b.v, _CMP_LE_OQ));
}
CASTRAY_INLINE Mask operator==(Uint a, Uint b) {
  return Mask(_mm512_cmpeq_epu32_mask((__m512i)a.v, (__m512i)b.v));
}
CASTRAY_INLINE Mask operator<(Uint a, Uint b) {
  return Mask(_mm512_cmplt_epu32_mask((__m512i)a.v, (__m512i)b.v));
}
CASTRAY_INLINE Float select(Mask m, Float a, Float b) {
  return (RawFloat)_mm512_mask_blend_ps(m.m, (__m512)b.v, (__m512)a.v);
}
CASTRAY_INLINE Uint select(Mask m, Uint a, Uint b) {
  return (RawUint)_mm512_mask_blend_epi32(m.m, (__m512i)b.v, (__m512i)a.v);
}
CASTRAY_INLINE Float fma(Float a, Float b, Float c) {
  return (RawFloat)_mm512_fmadd_ps((__m512)a.v, (__m512)b.v, (__m512)c.v);
}
CASTRAY_INLINE Float sqrt(Float a) { return (RawFloat)_mm512_maskz_sqrt_ps((__mmask16)0xffff, (__m512)a.v); }
CASTRAY_INLINE Float min(Float a, Float b) { return (RawFloat)_mm512_min_ps((__m512)a.v, (__m512)b.v); }
CASTRAY_INLINE Float max(Float a, Float b) { return (RawFloat)_mm512_max_ps((__m512)a.v, (__m512)b.v); }
CASTRAY_INLINE void compress_store(float* p, Mask m, Float a) {
  _mm512_storeu_ps(p, _mm512_maskz_compress_ps(m.m, (__m512)a.v));
}
CASTRAY_INLINE void compress_store(uint32_t* p, Mask m, Uint a) {
  _mm512_storeu_si512(p, _mm512_maskz_compress_epi32(m.m, (__m512i)a.v));
}
CASTRAY_INLINE Float gather(const float* base, Uint i) {
  return (RawFloat)_mm512_i32gather_ps((__m512i)i.v, base, 4);
}
CASTRAY_INLINE Uint gather(const uint32_t* base, Uint i) {
  return (RawUint)_mm512_i32gather_epi32((__m512i)i.v, base, 4);
}
/// Eight values from each of two places; in fewer lanes those of the first alone.
CASTRAY_INLINE Float load_octets(const float* low, const float* high) {
  return (RawFloat)_mm512_insertf32x8(_mm512_castps256_ps512(_mm256_loadu_ps(low)), _mm256_loadu_ps(high), 1);
}
/// table[i] for i < 16.
CASTRAY_INLINE Uint lookup16(const uint32_t* table, Uint i) {
  return (RawUint)_mm512_maskz_permutexvar_epi32((__mmask16)0xffff, (__m512i)i.v, _mm512_loadu_si512(table));
}
/// The four bytes from `base` + i on, the first in the lowest bits.
CASTRAY_INLINE Uint gather_bytes(const uint8_t* base, Uint i) {
  return (RawUint)_mm512_i32gather_epi32((__m512i)i.v, base, 1);
}
/// Bit i of the result is bit 31 - i of `a`.
CASTRAY_INLINE Uint reverse_bits(Uint a) {
  const __m512i low_nibbles = _mm512_set1_epi8(0x0f);
  const __m512i reversed =
      _mm512_broadcast_i32x4(_mm_setr_epi8(0, 8, 4, 12, 2, 10, 6, 14, 1, 9, 5, 13, 3, 11, 7, 15));
  const __m512i swap =
      _mm512_broadcast_i32x4(_mm_setr_epi8(3, 2, 1, 0, 7, 6, 5, 4, 11, 10, 9, 8, 15, 14, 13, 12));
  const __m512i low = _mm512_shuffle_epi8(reversed, _mm512_and_si512((__m512i)a.v, low_nibbles));
  const __m512i high = _mm512_shuffle_epi8(reversed, _mm512_and_si512((__m512i)(a.v >> 4), low_nibbles));
  return (RawUint)_mm512_shuffle_epi8((__m512i)((RawUint)low << 4 | (RawUint)high), swap);
}

}  // namespace castray::CASTRAY_ISA
