#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace castray {

/// Side in pixels of the tiles whose pixels share paths.
inline constexpr int tile_side = 8;

/// One sample of every pixel of a tile, whose paths are shared.
struct TileSamples {
  int x = 0, y = 0;          ///< top left pixel in the full image; may lie outside
  std::uint64_t sample = 0;  ///< its index
  std::uint64_t valid = 0;   ///< bit 8 row + column: the pixel lies in the full image, its sample is finite
  std::uint64_t kept = 0;    ///< likewise: of these, it lies in the film's window
  const float* radiance[3] = {};  ///< of pixel 8 row + column
  const float* emitted[3] = {};   ///< the part of it that the camera sees directly, lamps and sky
};

/// Sums from which differences of neighbouring pixels follow, over the samples in which both are in one tile:
/// then they share their paths, and most of their noise cancels. The samples of even index and those of odd
/// index, which must be independent of each other, are kept apart as two halves.
///
/// All are whole numbers, so that they do not depend on the order of addition. Radiance, here that of
/// reflected light alone, is rounded to a multiple of 2^-36 of the film's scale, up or down by a hash of
/// pixel and sample, right on average. Sums hold 2^27 samples as bright as the scale.
class DifferenceSums {
 public:
  static constexpr int halves = 2;
  enum Side { left, right, above, below };

  /// Of one pixel and half.
  struct alignas(64) Pixel {
    std::int64_t all[3];        ///< radiance
    std::int64_t root;          ///< square root of luminance
    std::int64_t spread_right;  ///< squared difference to that of the neighbour, over `with_right`
    std::int64_t spread_below;  ///< likewise
    std::uint32_t count;        ///< samples
    std::uint32_t with_right;   ///< of them, those whose tile has the neighbour to the right, too
    std::uint32_t with_below;   ///< likewise
    std::uint32_t unused;       ///< 0
  };
  /// By Side: radiance over the samples whose tile lacks the neighbour on that side.
  struct Apart {
    std::int64_t sum[4][3];
  };

  DifferenceSums() = default;
  DifferenceSums(std::size_t pixels, double scale)
      : kept_(true), scale_(scale), sums_(halves * pixels), apart_(halves * pixels) {}

  bool kept() const { return kept_; }
  const Pixel& at(std::size_t pixel, int half) const { return sums_[place(pixel, half)]; }
  const Apart& apart_at(std::size_t pixel, int half) const { return apart_[place(pixel, half)]; }

  /// Adds row `row` of a tile, as far as it is kept, to consecutive pixels; `first` is where that of column 0
  /// is or would be.
  void add(const TileSamples& tile, int row, std::ptrdiff_t first);
  /// Adds `count` pixels of another, from `from` on, to those from `to` on.
  void add(std::size_t to, const DifferenceSums& other, std::size_t from, std::size_t count);

  /// Radiance and luminance, of `all`, `apart` and `spread`, are these times the sum.
  double radiance_unit() const { return scale_ * 0x1p-36; }
  double spread_unit() const { return scale_ * 0x1p-44; }
  /// The square root of luminance.
  double root_unit() const;

  /// As they are in files: the even half, then the odd one.
  std::vector<Pixel>& sums() { return sums_; }
  const std::vector<Pixel>& sums() const { return sums_; }
  std::vector<Apart>& apart() { return apart_; }
  const std::vector<Apart>& apart() const { return apart_; }

 private:
  std::size_t place(std::size_t pixel, int half) const {
    return static_cast<std::size_t>(half) * (sums_.size() / halves) + pixel;
  }

  bool kept_ = false;
  double scale_ = 1;
  std::vector<Pixel> sums_;
  std::vector<Apart> apart_;
};

}  // namespace castray
