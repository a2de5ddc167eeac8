#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "castray/large_allocator.h"

namespace castray {

/// Side in pixels of the tiles whose pixels share paths.
inline constexpr int tile_side = 8;
/// How far outside its square a pixel of a ragged tile lies at most.
inline constexpr int tile_reach = tile_side / 2;

/// One sample of every pixel of a tile, whose paths are shared; or one of the takes of it, each in tiles of
/// its own, of which the sample is the mean.
struct TileSamples {
  int x = 0, y = 0;               ///< top left pixel in the full image; may lie outside
  std::uint64_t sample = 0;       ///< its index
  int take = 0, takes = 1;        ///< which of how many, 1 or DifferenceSums::most_takes
  std::uint64_t kept = 0;         ///< bit i: the sample counts, and lies in the film's window
  std::uint64_t smooth = 0;       ///< likewise: it is finite, and its pixel, of the full image, sees no edge
  const float* radiance[3] = {};  ///< of pixel i
  const float* emitted[3] = {};   ///< the part of it that the camera sees directly, lamps and sky
  /// Of a ragged tile, the place of pixel i in the full image, as signed numbers. Null: it is that of
  /// 8 row + column in a square.
  const std::uint32_t *ragged_x = nullptr, *ragged_y = nullptr;

  int x_of(int i) const { return ragged_x ? static_cast<int>(ragged_x[i]) : x + i % tile_side; }
  int y_of(int i) const { return ragged_y ? static_cast<int>(ragged_y[i]) : y + i / tile_side; }
};

/// Sums over the samples of smooth pixels: radiance, and the difference to each neighbour over the samples in
/// which both are in one tile. These share their paths, so that most of their noise cancels. The samples of
/// even index and those of odd index, which must be independent of each other, are kept apart as two halves.
///
/// All are whole numbers, so that they do not depend on the order of addition. Radiance, here that of
/// reflected light alone, is rounded to a multiple of 2^-36 of the film's scale. Sums hold 2^26 samples as
/// bright as the scale.
class DifferenceSums {
 public:
  static constexpr int halves = 2;
  /// What is summed of a pixel: its radiance, and how much greater that of a neighbour is.
  enum Term { own, right, below };
  static constexpr int terms = 3, channels = 3;
  /// Of a sample. Sums and counts are of takes: a sample of one take counts as so many alike.
  static constexpr int most_takes = 2;
  static constexpr std::size_t bytes_of_counts = halves * terms * sizeof(std::uint32_t),
                               bytes_of_sums = halves * terms * channels * sizeof(std::int64_t),
                               bytes_of_pixel = bytes_of_sums + bytes_of_counts;

  DifferenceSums() = default;
  DifferenceSums(int width, int height, double scale);

  bool kept() const { return kept_; }
  int width() const { return width_; }
  int height() const { return height_; }

  /// Of the pixels of row y, over their takes.
  const std::int64_t* sums(int half, int y, Term term, int channel) const {
    return &sums_[row(half, y) * channels + place(term * channels + channel)];
  }
  /// The number of these takes.
  const std::uint32_t* counts(int half, int y, Term term) const {
    return &counts_[row(half, y) + place(term)];
  }

  /// Adds rows y0 <= y < y1 of the full image, which lie in the window, of one sample of tiles side by side,
  /// from left to right, as far as they are kept. (left,top): the window's first pixel in the full image.
  void add(std::span<const TileSamples> tiles, int y0, int y1, int left, int top);
  /// Adds `count` pixels of another, from (other_x,other_y) on, to those from (x,y) on.
  void add_row(int x, int y, const DifferenceSums& other, int other_x, int other_y, int count);

  /// Radiance is this times the sum, over the number of takes; and the same over the film's scale.
  double radiance_unit() const { return scale_ * unit_over_scale; }
  static constexpr double unit_over_scale = 0x1p-36;
  double scale() const { return scale_; }

  /// As they are in files: by half, row, term, channel, column; and counts likewise.
  LargeVector<std::int64_t>& all_sums() { return sums_; }
  const LargeVector<std::int64_t>& all_sums() const { return sums_; }
  LargeVector<std::uint32_t>& all_counts() { return counts_; }
  const LargeVector<std::uint32_t>& all_counts() const { return counts_; }

 private:
  void add_strip(std::span<const TileSamples> tiles, int y0, int y1, int left, int top);

  /// Where the counts of a row begin.
  std::size_t row(int half, int y) const { return place((half * height_ + y) * std::ptrdiff_t{terms}); }
  std::size_t place(std::ptrdiff_t rows) const { return static_cast<std::size_t>(rows * width_); }

  bool kept_ = false;
  int width_ = 0, height_ = 0;
  double scale_ = 1;
  LargeVector<std::int64_t> sums_;
  LargeVector<std::uint32_t> counts_;
};

}  // namespace castray
