#pragma once

#include "simd/lanes.h"

// A struct that holds nothing but arrays of `size` 32-bit values is a table with these arrays as rows. Its
// entries (columns) can be copied without naming the arrays.

namespace castray::CASTRAY_ISA {

template <class Arrays>
inline constexpr int rows_of = sizeof(Arrays) / (Arrays::size * sizeof(uint32_t));

/// Copies entries i to i + width - 1 of `from`, those in `m`, to the entries of `to` from n on.
template <class Arrays>
CASTRAY_INLINE void compress_entries(Arrays& to, int n, Mask m, const Arrays& from, int i) {
  for (int row = 0; row < rows_of<Arrays>; ++row)
    compress_store((uint32_t*)&to + row * Arrays::size + n, m,
                   load((const uint32_t*)&from + row * Arrays::size + i));
}

/// Copies entry i of `from` to entry n of `to`.
template <class Arrays>
CASTRAY_INLINE void copy_entry(Arrays& to, int n, const Arrays& from, int i) {
  for (int row = 0; row < rows_of<Arrays>; ++row)
    ((uint32_t*)&to)[row * Arrays::size + n] = ((const uint32_t*)&from)[row * Arrays::size + i];
}

}  // namespace castray::CASTRAY_ISA
