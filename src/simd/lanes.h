#pragma once

#include <immintrin.h>
#include <stdint.h>

#include "simd/isa_lanes.h"

// The lane types: `width` values side by side, one path, ray or pixel each. Arithmetic is that of compiler
// vectors; intrinsics only where vectors have no operator (fused multiply-add, masks, compression, table
// look-up). Every operation is correctly rounded and acts lane by lane, so that sets with fused multiply-add
// agree to the bit.

namespace castray::CASTRAY_ISA {

inline constexpr int width = CASTRAY_WIDTH;

using RawFloat = float __attribute__((vector_size(4 * CASTRAY_WIDTH)));
using RawInt = int32_t __attribute__((vector_size(4 * CASTRAY_WIDTH)));
using RawUint = uint32_t __attribute__((vector_size(4 * CASTRAY_WIDTH)));

/// True or false in each lane.
struct Mask {
#if CASTRAY_WIDTH == 16
  __mmask16 m;
  CASTRAY_INLINE explicit Mask(__mmask16 bits) : m(bits) {}
  CASTRAY_INLINE explicit Mask(bool all) : m(all ? __mmask16(0xffff) : __mmask16(0)) {}
#else
  RawInt m;
  CASTRAY_INLINE explicit Mask(RawInt bits) : m(bits) {}
  CASTRAY_INLINE explicit Mask(bool all) : m(RawInt{} - (all ? 1 : 0)) {}
#endif
  Mask() = default;
};

/// `width` floats.
struct Float {
  RawFloat v;
  Float() = default;
  CASTRAY_INLINE Float(RawFloat raw) : v(raw) {}
  CASTRAY_INLINE Float(float s) : v(s - RawFloat{}) {}  // 0 + s would cost an addition: it is not -0 for -0
};

/// `width` unsigned 32-bit integers.
struct Uint {
  RawUint v;
  Uint() = default;
  CASTRAY_INLINE Uint(RawUint raw) : v(raw) {}
  CASTRAY_INLINE Uint(uint32_t s) : v(RawUint{} + s) {}
};

CASTRAY_INLINE Float operator+(Float a, Float b) { return a.v + b.v; }
CASTRAY_INLINE Float operator-(Float a, Float b) { return a.v - b.v; }
CASTRAY_INLINE Float operator*(Float a, Float b) { return a.v * b.v; }
CASTRAY_INLINE Float operator/(Float a, Float b) { return a.v / b.v; }
CASTRAY_INLINE Float operator-(Float a) { return -a.v; }
CASTRAY_INLINE Float& operator+=(Float& a, Float b) { return a = a + b; }
CASTRAY_INLINE Float& operator*=(Float& a, Float b) { return a = a * b; }

CASTRAY_INLINE Uint operator+(Uint a, Uint b) { return a.v + b.v; }
CASTRAY_INLINE Uint operator-(Uint a, Uint b) { return a.v - b.v; }
CASTRAY_INLINE Uint operator*(Uint a, Uint b) { return a.v * b.v; }
CASTRAY_INLINE Uint operator&(Uint a, Uint b) { return a.v & b.v; }
CASTRAY_INLINE Uint operator|(Uint a, Uint b) { return a.v | b.v; }
CASTRAY_INLINE Uint operator^(Uint a, Uint b) { return a.v ^ b.v; }
CASTRAY_INLINE Uint operator<<(Uint a, int n) { return a.v << n; }
CASTRAY_INLINE Uint operator>>(Uint a, int n) { return a.v >> n; }
CASTRAY_INLINE Uint operator>>(Uint a, Uint n) { return a.v >> n.v; }

CASTRAY_INLINE Uint as_uint(Float a) { return (RawUint)a.v; }
CASTRAY_INLINE Float as_float(Uint a) { return (RawFloat)a.v; }
/// Exact for values below 2^24; values are taken as signed.
CASTRAY_INLINE Float to_float(Uint a) { return __builtin_convertvector((RawInt)a.v, RawFloat); }
/// Towards zero; values from 0 to 2^31 - 1.
CASTRAY_INLINE Uint to_uint(Float a) { return (RawUint) __builtin_convertvector(a.v, RawInt); }

/// 0, 1, 2, ... width - 1.
CASTRAY_INLINE Uint lane_index() {
  RawUint v;
  for (int i = 0; i < width; ++i) v[i] = (uint32_t)i;
  return v;
}

CASTRAY_INLINE Float load(const float* p) {
  RawFloat v;
  __builtin_memcpy(&v, p, sizeof v);
  return v;
}
CASTRAY_INLINE Uint load(const uint32_t* p) {
  RawUint v;
  __builtin_memcpy(&v, p, sizeof v);
  return v;
}
CASTRAY_INLINE void store(float* p, Float a) { __builtin_memcpy(p, &a.v, sizeof a.v); }
CASTRAY_INLINE void store(uint32_t* p, Uint a) { __builtin_memcpy(p, &a.v, sizeof a.v); }

#if CASTRAY_WIDTH == 16

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

#else

CASTRAY_INLINE Mask operator&(Mask a, Mask b) { return Mask(a.m & b.m); }
CASTRAY_INLINE Mask operator|(Mask a, Mask b) { return Mask(a.m | b.m); }
CASTRAY_INLINE Mask operator~(Mask a) { return Mask(~a.m); }
CASTRAY_INLINE Mask operator<(Float a, Float b) { return Mask((RawInt)(a.v < b.v)); }
CASTRAY_INLINE Mask operator<=(Float a, Float b) { return Mask((RawInt)(a.v <= b.v)); }
CASTRAY_INLINE Mask operator==(Uint a, Uint b) { return Mask((RawInt)(a.v == b.v)); }
CASTRAY_INLINE Mask operator<(Uint a, Uint b) { return Mask((RawInt)(a.v < b.v)); }

#if CASTRAY_WIDTH == 8

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

#else

#if CASTRAY_WIDTH == 4
CASTRAY_INLINE uint32_t bits(Mask a) { return (uint32_t)_mm_movemask_ps((__m128)a.m); }
CASTRAY_INLINE Float select(Mask m, Float a, Float b) {
  return (RawFloat)_mm_blendv_ps((__m128)b.v, (__m128)a.v, (__m128)m.m);
}
CASTRAY_INLINE Uint select(Mask m, Uint a, Uint b) {
  return (RawUint)_mm_blendv_epi8((__m128i)b.v, (__m128i)a.v, (__m128i)m.m);
}
CASTRAY_INLINE Float sqrt(Float a) { return (RawFloat)_mm_sqrt_ps((__m128)a.v); }
CASTRAY_INLINE Float min(Float a, Float b) { return (RawFloat)_mm_min_ps((__m128)a.v, (__m128)b.v); }
CASTRAY_INLINE Float max(Float a, Float b) { return (RawFloat)_mm_max_ps((__m128)a.v, (__m128)b.v); }
#else
CASTRAY_INLINE uint32_t bits(Mask a) { return a.m[0] ? 1u : 0u; }
CASTRAY_INLINE Float select(Mask m, Float a, Float b) { return m.m[0] ? a : b; }
CASTRAY_INLINE Uint select(Mask m, Uint a, Uint b) { return m.m[0] ? a : b; }
CASTRAY_INLINE Float sqrt(Float a) { return Float(__builtin_sqrtf(a.v[0])); }
CASTRAY_INLINE Float min(Float a, Float b) { return a.v[0] < b.v[0] ? a : b; }
CASTRAY_INLINE Float max(Float a, Float b) { return a.v[0] > b.v[0] ? a : b; }
#endif
CASTRAY_INLINE Float fma(Float a, Float b, Float c) { return a * b + c; }
CASTRAY_INLINE Float gather(const float* base, Uint i) {
  alignas(4 * width) float v[width];
  for (int l = 0; l < width; ++l) __builtin_memcpy(v + l, base + i.v[l], sizeof *v);
  return load(v);
}
CASTRAY_INLINE Uint gather(const uint32_t* base, Uint i) {
  alignas(4 * width) uint32_t v[width];
  for (int l = 0; l < width; ++l) __builtin_memcpy(v + l, base + i.v[l], sizeof *v);
  return load(v);
}
CASTRAY_INLINE void compress_store(uint32_t* p, Mask m, Uint a) {
  for (int l = 0; l < width; ++l) {
    const uint32_t value = a.v[l];
    if (m.m[l]) __builtin_memcpy(p++, &value, sizeof value);
  }
}
CASTRAY_INLINE void compress_store(float* p, Mask m, Float a) { compress_store((uint32_t*)p, m, as_uint(a)); }
/// table[i] for i < 16.
CASTRAY_INLINE Uint lookup16(const uint32_t* table, Uint i) { return gather(table, i); }

#endif

CASTRAY_INLINE Float load_octets(const float* first, const float*) { return load(first); }
/// Lane l is bit l of `b`.
CASTRAY_INLINE Mask mask_of_bits(uint32_t b) {
  const RawInt lane_bit = (RawInt)(RawUint{} + 1u) << (RawInt)lane_index().v;
  return Mask((RawInt)(((RawInt{} + (int32_t)b) & lane_bit) != 0));
}

#endif

/// The four bytes from `base` + i on, the first in the lowest bits.
CASTRAY_INLINE Uint gather_bytes(const uint8_t* base, Uint i) {
#if CASTRAY_WIDTH == 16
  return (RawUint)_mm512_i32gather_epi32((__m512i)i.v, base, 1);
#elif CASTRAY_WIDTH == 8
  return (RawUint)_mm256_i32gather_epi32((const int*)base, (__m256i)i.v, 1);
#else
  RawUint v;
  for (int l = 0; l < width; ++l) {
    uint32_t word;
    __builtin_memcpy(&word, base + i.v[l], sizeof word);
    v[l] = word;
  }
  return v;
#endif
}

/// Bit i of the result is bit 31 - i of `a`.
CASTRAY_INLINE Uint reverse_bits(Uint a) {
#if CASTRAY_WIDTH == 16
  const __m512i low_nibbles = _mm512_set1_epi8(0x0f);
  const __m512i reversed =
      _mm512_broadcast_i32x4(_mm_setr_epi8(0, 8, 4, 12, 2, 10, 6, 14, 1, 9, 5, 13, 3, 11, 7, 15));
  const __m512i swap =
      _mm512_broadcast_i32x4(_mm_setr_epi8(3, 2, 1, 0, 7, 6, 5, 4, 11, 10, 9, 8, 15, 14, 13, 12));
  const __m512i low = _mm512_shuffle_epi8(reversed, _mm512_and_si512((__m512i)a.v, low_nibbles));
  const __m512i high = _mm512_shuffle_epi8(reversed, _mm512_and_si512((__m512i)(a.v >> 4), low_nibbles));
  return (RawUint)_mm512_shuffle_epi8((__m512i)((RawUint)low << 4 | (RawUint)high), swap);
#elif CASTRAY_WIDTH == 8
  const __m256i low_nibbles = _mm256_set1_epi8(0x0f);
  const __m256i reversed =
      _mm256_broadcastsi128_si256(_mm_setr_epi8(0, 8, 4, 12, 2, 10, 6, 14, 1, 9, 5, 13, 3, 11, 7, 15));
  const __m256i swap =
      _mm256_broadcastsi128_si256(_mm_setr_epi8(3, 2, 1, 0, 7, 6, 5, 4, 11, 10, 9, 8, 15, 14, 13, 12));
  const __m256i low = _mm256_shuffle_epi8(reversed, _mm256_and_si256((__m256i)a.v, low_nibbles));
  const __m256i high = _mm256_shuffle_epi8(reversed, _mm256_and_si256((__m256i)(a.v >> 4), low_nibbles));
  return (RawUint)_mm256_shuffle_epi8((__m256i)((RawUint)low << 4 | (RawUint)high), swap);
#else
  a = (a >> 16) | (a << 16);
  a = ((a & 0xff00ff00u) >> 8) | ((a & 0x00ff00ffu) << 8);
  a = ((a & 0xf0f0f0f0u) >> 4) | ((a & 0x0f0f0f0fu) << 4);
  a = ((a & 0xccccccccu) >> 2) | ((a & 0x33333333u) << 2);
  return ((a & 0xaaaaaaaau) >> 1) | ((a & 0x55555555u) << 1);
#endif
}

CASTRAY_INLINE Mask operator>(Float a, Float b) { return b < a; }
CASTRAY_INLINE Mask operator>=(Float a, Float b) { return b <= a; }
CASTRAY_INLINE bool any(Mask a) { return bits(a) != 0; }
CASTRAY_INLINE bool none(Mask a) { return bits(a) == 0; }
CASTRAY_INLINE bool all(Mask a) { return bits(a) == (1u << width) - 1u; }
CASTRAY_INLINE int count(Mask a) { return __builtin_popcount(bits(a)); }
/// The first n lanes.
CASTRAY_INLINE Mask first_lanes(int n) { return lane_index() < Uint((uint32_t)n); }

CASTRAY_INLINE Float abs(Float a) { return as_float(as_uint(a) & Uint(0x7fffffffu)); }
/// `a` with its sign flipped where `b` is negative.
CASTRAY_INLINE Float flip_by_sign(Float a, Float b) {
  return as_float(as_uint(a) ^ (as_uint(b) & Uint(0x80000000u)));
}
CASTRAY_INLINE Float copy_sign(Float a, Float sign) {
  return as_float((as_uint(a) & Uint(0x7fffffffu)) | (as_uint(sign) & Uint(0x80000000u)));
}
CASTRAY_INLINE float lane(Float a, int l) { return a.v[l]; }
CASTRAY_INLINE uint32_t lane(Uint a, int l) { return a.v[l]; }

/// Where the fields of a table's records begin: the table's address and a distance, which may be indexed past
/// the first record. The address of the first record's own field may not: the compiler takes it that the
/// index stays inside.
template <class Record, class Field>
CASTRAY_INLINE const Field* fields_of(const Record* table, Field Record::*field) {
  return (const Field*)((const char*)table + ((const char*)&(table->*field) - (const char*)table));
}
template <class Record, class Field, int N>
CASTRAY_INLINE const Field* fields_of(const Record* table, Field (Record::*field)[N]) {
  return (const Field*)((const char*)table + ((const char*)&(table->*field) - (const char*)table));
}
/// A field, or its first element, of the records that begin `offset` words of 32 bits after the table.
template <class Record, class Field>
CASTRAY_INLINE auto gather(const Record* table, Field Record::*field, Uint offset) {
  return gather(fields_of(table, field), offset);
}

/// `width` numbers from `i` on, zeros behind the last.
CASTRAY_INLINE Float load_padded(const float* from, uint32_t i, uint32_t count) {
  if (i + width <= count) return load(from + i);
  alignas(64) float padded[width] = {};
  for (uint32_t l = 0; i + l < count; ++l) padded[l] = from[i + l];
  return load(padded);
}

}  // namespace castray::CASTRAY_ISA
