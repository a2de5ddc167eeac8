#pragma once

#include <emmintrin.h>

#include <bit>

namespace castray {

/// Eight numbers side by side, in as many registers as it takes. Passed by reference only: by value they
/// would have another ABI on each processor.
template <class T>
using Lanes8 [[gnu::vector_size(8 * sizeof(T))]] = T;

inline const Lanes8<float>& lanes8(const float* p) { return *reinterpret_cast<const Lanes8<float>*>(p); }

/// Bit l is set where lane l of a comparison is.
inline unsigned bits8(const Lanes8<int>& comparison) {
  struct Halves {
    __m128 low, high;
  };
  const auto h = std::bit_cast<Halves>(comparison);
  return static_cast<unsigned>(_mm_movemask_ps(h.low) | _mm_movemask_ps(h.high) << 4);
}
inline unsigned bits8(const Lanes8<long>& comparison) {
  return bits8(__builtin_convertvector(comparison, Lanes8<int>));
}

}  // namespace castray
