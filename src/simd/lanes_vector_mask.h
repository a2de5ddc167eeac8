#pragma once

#include "simd/lane_types.h"

namespace castray::CASTRAY_ISA {

/// True or false in each lane: all bits of a lane are set, or none.
struct Mask {
  RawInt m;
  CASTRAY_INLINE explicit Mask(RawInt bits) : m(bits) {}
  CASTRAY_INLINE explicit Mask(bool all) : m(RawInt{} - (all ? 1 : 0)) {}
  Mask() = default;
};
CASTRAY_INLINE Mask operator&(Mask a, Mask b) { return Mask(a.m & b.m); }
CASTRAY_INLINE Mask operator|(Mask a, Mask b) { return Mask(a.m | b.m); }
CASTRAY_INLINE Mask operator~(Mask a) { return Mask(~a.m); }
CASTRAY_INLINE Mask operator<(Float a, Float b) { return Mask((RawInt)(a.v < b.v)); }
CASTRAY_INLINE Mask operator<=(Float a, Float b) { return Mask((RawInt)(a.v <= b.v)); }
CASTRAY_INLINE Mask operator==(Uint a, Uint b) { return Mask((RawInt)(a.v == b.v)); }
CASTRAY_INLINE Mask operator<(Uint a, Uint b) { return Mask((RawInt)(a.v < b.v)); }
/// Lane l is bit l of `b`.
CASTRAY_INLINE Mask mask_of_bits(uint32_t b) {
  const RawInt lane_bit = (RawInt)(RawUint{} + 1u) << (RawInt)lane_index().v;
  return Mask((RawInt)(((RawInt{} + (int32_t)b) & lane_bit) != 0));
}
CASTRAY_INLINE Float load_octets(const float* first, const float*) { return load(first); }

}  // namespace castray::CASTRAY_ISA
