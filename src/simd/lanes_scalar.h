#pragma once

#include "simd/lane_types.h"

namespace castray::CASTRAY_ISA {

/// True or false. No compiler vector: GCC 12 turns comparisons of vectors of one element into booleans of 32
/// bits with the value 1, where its range propagation allows 0 and -1 only.
struct Mask {
  bool m;
  CASTRAY_INLINE explicit Mask(bool all) : m(all) {}
  Mask() = default;
};
CASTRAY_INLINE Mask operator&(Mask a, Mask b) { return Mask(a.m && b.m); }
CASTRAY_INLINE Mask operator|(Mask a, Mask b) { return Mask(a.m || b.m); }
CASTRAY_INLINE Mask operator~(Mask a) { return Mask(!a.m); }
CASTRAY_INLINE Mask operator<(Float a, Float b) { return Mask(a.v[0] < b.v[0]); }
CASTRAY_INLINE Mask operator<=(Float a, Float b) { return Mask(a.v[0] <= b.v[0]); }
CASTRAY_INLINE Mask operator==(Uint a, Uint b) { return Mask(a.v[0] == b.v[0]); }
CASTRAY_INLINE Mask operator<(Uint a, Uint b) { return Mask(a.v[0] < b.v[0]); }
CASTRAY_INLINE uint32_t bits(Mask a) { return a.m ? 1u : 0u; }
CASTRAY_INLINE Mask mask_of_bits(uint32_t b) { return Mask((b & 1u) != 0); }
CASTRAY_INLINE Float select(Mask m, Float a, Float b) { return m.m ? a : b; }
CASTRAY_INLINE Uint select(Mask m, Uint a, Uint b) { return m.m ? a : b; }
CASTRAY_INLINE Float sqrt(Float a) { return Float(__builtin_sqrtf(a.v[0])); }
/// Of two NaN or equal operands the second, as the instructions do.
CASTRAY_INLINE Float min(Float a, Float b) { return a.v[0] < b.v[0] ? a : b; }
CASTRAY_INLINE Float max(Float a, Float b) { return a.v[0] > b.v[0] ? a : b; }
CASTRAY_INLINE Float fma(Float a, Float b, Float c) { return a * b + c; }
CASTRAY_INLINE Float gather(const float* base, Uint i) { return load(base + i.v[0]); }
CASTRAY_INLINE Uint gather(const uint32_t* base, Uint i) { return load(base + i.v[0]); }
CASTRAY_INLINE Uint gather_bytes(const uint8_t* base, Uint i) {
  uint32_t word;
  __builtin_memcpy(&word, base + i.v[0], sizeof word);
  return word;
}
CASTRAY_INLINE void compress_store(float* p, Mask m, Float a) {
  if (m.m) store(p, a);
}
CASTRAY_INLINE void compress_store(uint32_t* p, Mask m, Uint a) {
  if (m.m) store(p, a);
}
CASTRAY_INLINE Float load_octets(const float* first, const float*) { return load(first); }
CASTRAY_INLINE Uint lookup16(const uint32_t* table, Uint i) { return gather(table, i); }
CASTRAY_INLINE Uint reverse_bits(Uint a) {
  a = (a >> 16) | (a << 16);
  a = ((a & 0xff00ff00u) >> 8) | ((a & 0x00ff00ffu) << 8);
  a = ((a & 0xf0f0f0f0u) >> 4) | ((a & 0x0f0f0f0fu) << 4);
  a = ((a & 0xccccccccu) >> 2) | ((a & 0x33333333u) << 2);
  return ((a & 0xaaaaaaaau) >> 1) | ((a & 0x55555555u) << 1);
}

}  // namespace castray::CASTRAY_ISA
