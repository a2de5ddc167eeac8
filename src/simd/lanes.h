#pragma once

// The lane types: `width` values side by side, one path, ray or pixel each. Every operation is correctly
// rounded and acts lane by lane, so that sets with fused multiply-add agree to the bit. Intrinsics are used
// only where compiler vectors have no operator: fused multiply-add, masks, compression, table look-up.

#include "simd/isa_lanes.h"
#if CASTRAY_WIDTH == 16
#include "simd/lanes_avx512.h"
#elif CASTRAY_WIDTH == 8
#include "simd/lanes_avx2.h"
#elif CASTRAY_WIDTH == 4
#include "simd/lanes_sse4.h"
#else
#include "simd/lanes_scalar.h"
#endif

namespace castray::CASTRAY_ISA {

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

/// Address of a field in a table of records, to be indexed over all records. It is computed from the
/// table: indexing from the first record's field past that field is undefined, and compilers make use of
/// that.
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
