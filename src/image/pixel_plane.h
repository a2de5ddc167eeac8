#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "castray/large_allocator.h"

namespace castray {

/// How strongly two pixels are coupled, at least 0, rounded to the upper half of a float, which is within
/// 1/512 of it: weights need not be exact, and reading them takes longer than to work with them.
class Coupling {
 public:
  Coupling() = default;
  Coupling(float weight)
      : upper_half_(static_cast<std::uint16_t>((std::bit_cast<std::uint32_t>(weight) + 0x8000U) >> 16)) {}
  operator float() const { return std::bit_cast<float>(std::uint32_t{upper_half_} << 16); }

 private:
  std::uint16_t upper_half_;
};

/// A value of every pixel, with a border of zeros one pixel wide. Rows of floats begin at cache lines.
template <class T>
struct PlaneOf {
  static constexpr int line = 16;  ///< floats of a cache line

  int stride = 0;
  LargeVector<T> values;

  PlaneOf() = default;
  PlaneOf(int width, int height) : stride(stride_of(width)), values(size_of(width, height)) {}
  static std::uint64_t bytes_of(int width, int height) {
    return bytes_in_large_pages(sizeof(T) * size_of(width, height));
  }
  /// Row -1 <= y <= height, so that columns -1 <= x <= width can be read.
  T* row(int y) { return &values[line + static_cast<std::size_t>(y + 1) * static_cast<std::size_t>(stride)]; }
  const T* row(int y) const { return const_cast<PlaneOf*>(this)->row(y); }

 private:
  /// The zeros after a row are those before the next.
  static int stride_of(int width) { return (width + line) / line * line; }
  static std::size_t size_of(int width, int height) {
    return line + static_cast<std::size_t>(stride_of(width)) * static_cast<std::size_t>(height + 2);
  }
};
using PixelPlane = PlaneOf<float>;
using PixelPlanes = std::array<PixelPlane, 3>;
using CouplingPlane = PlaneOf<Coupling>;

}  // namespace castray
