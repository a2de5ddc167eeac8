#pragma once

#include "simd/lanes_vector_mask.h"

namespace castray::CASTRAY_ISA {

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
/// The four bytes from `base` + i on, the first in the lowest bits.
CASTRAY_INLINE Uint gather_bytes(const uint8_t* base, Uint i) {
  RawUint v;
  for (int l = 0; l < width; ++l) {
    uint32_t word;
    __builtin_memcpy(&word, base + i.v[l], sizeof word);
    v[l] = word;
  }
  return v;
}
/// Bit i of the result is bit 31 - i of `a`.
CASTRAY_INLINE Uint reverse_bits(Uint a) {
  a = (a >> 16) | (a << 16);
  a = ((a & 0xff00ff00u) >> 8) | ((a & 0x00ff00ffu) << 8);
  a = ((a & 0xf0f0f0f0u) >> 4) | ((a & 0x0f0f0f0fu) << 4);
  a = ((a & 0xccccccccu) >> 2) | ((a & 0x33333333u) << 2);
  return ((a & 0xaaaaaaaau) >> 1) | ((a & 0x55555555u) << 1);
}

}  // namespace castray::CASTRAY_ISA
