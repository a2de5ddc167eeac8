#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "castray/film.h"

namespace castray {

/// Which samples each pixel of a window gets: those with indices first <= i < first + n, n that of its block.
/// Blocks are squares of the full image's grid, cut at the window.
class SampleMap {
 public:
  /// Side of a block in pixels: several tiles of shared paths, so that a block's noise can be estimated.
  static constexpr int block_side = 32;

  /// The same samples everywhere.
  SampleMap(const Window& window, const SampleRange& samples);

  std::size_t blocks() const { return counts_.size(); }
  /// The part of the window that is block i.
  Window block(std::size_t i) const;
  std::uint64_t count(std::size_t i) const { return counts_[i]; }
  void set_counts(std::vector<std::uint64_t> counts);
  void set_first(std::uint64_t first) { first_ = first; }

  /// From the first index to the last that any block gets.
  SampleRange range() const { return {first_, most_}; }
  /// Of all pixels.
  std::uint64_t total() const;
  /// Of the pixels in rows y0 <= y < y1, among the indices `samples`.
  std::uint64_t total(int y0, int y1, const SampleRange& samples) const;

  /// Whether pixel (x,y) of the window gets this sample of the range.
  bool wants(int x, int y, std::uint64_t sample) const {
    return uniform_ || sample - first_ < counts_[index(x, y)];
  }
  /// Whether all pixels of a rectangle in the window do, whose sides are at most those of a block.
  bool wants_all(int x0, int y0, int x1, int y1, std::uint64_t sample) const {
    return wants(x0, y0, sample) && wants(x1 - 1, y0, sample) && wants(x0, y1 - 1, sample) &&
           wants(x1 - 1, y1 - 1, sample);
  }
  /// Whether any pixel of the window with x0 <= x < x1, y0 <= y < y1 does.
  bool wants_any(int x0, int y0, int x1, int y1, std::uint64_t sample) const;

 private:
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>((y / block_side - window_.y0 / block_side) * columns_ +
                                    (x / block_side - window_.x0 / block_side));
  }

  Window window_;
  int columns_;
  std::uint64_t first_, most_;
  bool uniform_ = true;
  std::vector<std::uint64_t> counts_;  ///< by block, row by row
};

}  // namespace castray
