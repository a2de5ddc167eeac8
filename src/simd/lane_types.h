#pragma once

#include <immintrin.h>
#include <stdint.h>

#include "simd/isa_lanes.h"

// Numbers side by side, with the arithmetic of compiler vectors.

namespace castray::CASTRAY_ISA {

inline constexpr int width = CASTRAY_WIDTH;

using RawFloat = float __attribute__((vector_size(4 * CASTRAY_WIDTH)));
using RawInt = int32_t __attribute__((vector_size(4 * CASTRAY_WIDTH)));
using RawUint = uint32_t __attribute__((vector_size(4 * CASTRAY_WIDTH)));

/// `width` floats.
struct Float {
  RawFloat v;
  Float() = default;
  CASTRAY_INLINE Float(RawFloat raw) : v(raw) {}
  CASTRAY_INLINE Float(float s)
      : v(s - RawFloat{}) {}  // a plain broadcast; 0 + s is an addition, as 0 + -0 is 0
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

}  // namespace castray::CASTRAY_ISA
