#pragma once

#include <immintrin.h>
#include <stdint.h>

#include "simd/isa_lanes.h"

// Eight floats side by side on every instruction set, for the eight boxes of a node and the eight triangles
// of a packet (lanes.h has as many lanes as the set's registers). Compiler vectors, which are split where
// registers are shorter.

namespace castray::CASTRAY_ISA {

using F8 = float __attribute__((vector_size(32)));
using I8 = int32_t __attribute__((vector_size(32)));
using U8 = uint32_t __attribute__((vector_size(32)));

CASTRAY_INLINE F8 load8(const float* p) { return *(const F8*)p; }
CASTRAY_INLINE F8 splat8(float s) { return s - F8{}; }  // a plain broadcast, see Float

CASTRAY_INLINE F8 load8(const int16_t* p) {
  using Shorts = int16_t __attribute__((vector_size(16)));
  return __builtin_convertvector(__builtin_convertvector(*(const Shorts*)p, I8), F8);
}
CASTRAY_INLINE F8 load8(const uint16_t* p) {
  using Shorts = uint16_t __attribute__((vector_size(16)));
  return __builtin_convertvector(__builtin_convertvector(*(const Shorts*)p, I8), F8);
}

CASTRAY_INLINE F8 sqrt8(F8 a) {
#ifdef __AVX2__
  return (F8)_mm256_sqrt_ps((__m256)a);
#else
  __m128 half[2];
  __builtin_memcpy(half, &a, sizeof half);
  for (__m128& h : half) h = _mm_sqrt_ps(h);
  __builtin_memcpy(&a, half, sizeof half);
  return a;
#endif
}

/// Of two NaN or equal operands the second, as the instructions do.
CASTRAY_INLINE F8 min8(F8 a, F8 b) {
#ifdef __AVX2__
  return (F8)_mm256_min_ps((__m256)a, (__m256)b);
#else
  return a < b ? a : b;
#endif
}
CASTRAY_INLINE F8 max8(F8 a, F8 b) {
#ifdef __AVX2__
  return (F8)_mm256_max_ps((__m256)a, (__m256)b);
#else
  return a > b ? a : b;
#endif
}

/// a * b - c, rounded once or twice, for where either will do.
CASTRAY_INLINE F8 about_mul_sub8(F8 a, F8 b, F8 c) {
#ifdef __FMA__
  return (F8)_mm256_fmsub_ps((__m256)a, (__m256)b, (__m256)c);
#else
  return a * b - c;
#endif
}

/// Bit l is set where a < b and c < d in lane l; with `or_equal` where a <= b and c <= d.
template <bool or_equal>
CASTRAY_INLINE uint32_t both_less8(F8 a, F8 b, F8 c, F8 d) {
#if defined(__AVX512VL__)
  constexpr int compare = or_equal ? _CMP_LE_OQ : _CMP_LT_OQ;
  return _mm256_mask_cmp_ps_mask(_mm256_cmp_ps_mask((__m256)a, (__m256)b, compare), (__m256)c, (__m256)d,
                                 compare);
#else
  const I8 both = or_equal ? (a <= b) & (c <= d) : (a < b) & (c < d);
#ifdef __AVX2__
  return (uint32_t)_mm256_movemask_ps((__m256)both);
#else
  __m128 half[2];
  __builtin_memcpy(half, &both, sizeof half);
  return (uint32_t)_mm_movemask_ps(half[0]) | (uint32_t)_mm_movemask_ps(half[1]) << 4;
#endif
#endif
}

/// a * b - c * d in each lane to two ulps and of the exact sign; see difference_of_products in
/// geometry/triangle.h, with which it agrees to the bit. Without fused multiply-add only the lanes in `lanes`
/// are computed.
CASTRAY_INLINE F8 difference_of_products8(F8 a, F8 b, F8 c, F8 d, [[maybe_unused]] uint32_t lanes) {
#ifdef __FMA__
  const __m256 cd = _mm256_mul_ps((__m256)c, (__m256)d);
  const __m256 error = _mm256_fmsub_ps((__m256)c, (__m256)d, cd);
  return (F8)_mm256_sub_ps(_mm256_fmsub_ps((__m256)a, (__m256)b, cd), error);
#else
  F8 result{};
  for (; lanes; lanes &= lanes - 1) {
    const int l = __builtin_ctz(lanes);
    const float cd = c[l] * d[l];
    const float error = __builtin_fmaf(c[l], d[l], -cd);
    result[l] = __builtin_fmaf(a[l], b[l], -cd) - error;
  }
  return result;
#endif
}

#ifdef __AVX2__
/// The lanes set in `mask`, packed to the front, as a permutation.
CASTRAY_INLINE __m256i packing8(uint32_t mask) {
  const uint64_t spread = _pdep_u64(mask, 0x0101010101010101ull) * 0xff;
  return _mm256_cvtepu8_epi32(_mm_cvtsi64_si128((long long)_pext_u64(0x0706050403020100ull, spread)));
}

/// Stores the lanes in `mask` one after the other, then garbage; returns their number.
CASTRAY_INLINE uint32_t store_packed8(__m256 t, __m256i child, uint32_t mask, float* out_t,
                                      uint32_t* out_child) {
#ifdef __AVX512VL__
  _mm256_storeu_ps(out_t, _mm256_maskz_compress_ps((__mmask8)mask, t));
  _mm256_storeu_si256((__m256i*)out_child, _mm256_maskz_compress_epi32((__mmask8)mask, child));
#else
  const __m256i packing = packing8(mask);
  _mm256_storeu_ps(out_t, _mm256_permutevar8x32_ps(t, packing));
  _mm256_storeu_si256((__m256i*)out_child, _mm256_permutevar8x32_epi32(child, packing));
#endif
  return (uint32_t)__builtin_popcount(mask);
}
#endif

/// Stores near and child of the lanes in which near <= far, in the order of `order` (four bits a lane, the
/// first lowest); returns how many. Writes eight of each.
CASTRAY_INLINE uint32_t push_in_order(F8 near, F8 far, const uint32_t* child, uint32_t order, float* out_near,
                                      uint32_t* out_child) {
#ifdef __AVX2__
  const __m256i lanes =
      _mm256_srlv_epi32(_mm256_set1_epi32((int)order), _mm256_setr_epi32(0, 4, 8, 12, 16, 20, 24, 28));
  const __m256 n = _mm256_permutevar8x32_ps((__m256)near, lanes),
               f = _mm256_permutevar8x32_ps((__m256)far, lanes);
  const __m256i c = _mm256_permutevar8x32_epi32(*(const __m256i*)child, lanes);
#ifdef __AVX512VL__
  const uint32_t mask = _mm256_cmp_ps_mask(n, f, _CMP_LE_OQ);
#else
  const uint32_t mask = (uint32_t)_mm256_movemask_ps(_mm256_cmp_ps(n, f, _CMP_LE_OQ));
#endif
  return store_packed8(n, c, mask, out_near, out_child);
#else
  const uint32_t mask = both_less8<true>(near, far, near, far);
  uint32_t n = 0;
  for (int i = 0; i < 8; ++i, order >>= 4) {
    const uint32_t lane = order & 7;
    out_near[n] = near[lane];
    out_child[n] = child[lane];
    n += mask >> lane & 1;
  }
  return n;
#endif
}

/// Of the `count` pairs from `t[from]` and `child[from]` on, at most eight, moves those with t <= limit to
/// `to` and on; returns how many.
CASTRAY_INLINE uint32_t pack8(float* t, uint32_t* child, uint32_t from, uint32_t count, float limit,
                              uint32_t to) {
#ifdef __AVX2__
  const __m256 ts = _mm256_loadu_ps(t + from);
  const __m256i children = _mm256_loadu_si256((const __m256i*)(child + from));
  const uint32_t near = (uint32_t)_mm256_movemask_ps(_mm256_cmp_ps(ts, _mm256_set1_ps(limit), _CMP_LE_OQ));
  return store_packed8(ts, children, count < 8 ? near & ((1u << count) - 1) : near, t + to, child + to);
#else
  uint32_t n = 0;
  for (uint32_t i = from; i < from + (count < 8 ? count : 8); ++i) {
    const float ti = t[i];
    const uint32_t ci = child[i];
    t[to + n] = ti;
    child[to + n] = ci;
    n += ti <= limit;
  }
  return n;
#endif
}

}  // namespace castray::CASTRAY_ISA
