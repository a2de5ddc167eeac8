#pragma once

#include <cstdint>
#include <vector>

#include "castray/differences.h"
#include "image/row_means.h"
#include "image/screened_poisson.h"

namespace castray {

/// What one half of a film's samples, or both, says of a strip of rows: what means and differences contradict
/// each other, and how far it would trust them.
class HalfStrip {
 public:
  static constexpr int rows = 16;  ///< of a strip; the first is a multiple of this

  HalfStrip(const DifferenceSums& sums, int half);

  /// Has the rows from `begin` on.
  void read(int begin);
  int begin() const { return begin_; }
  int end() const { return end_; }

  /// By how much the difference of a pixel of row y and its neighbour to the right is more than that of their
  /// means; below likewise.
  const float* right_contradiction(std::size_t channel, int y) const {
    return right_contradictions_[channel].row(y - begin_);
  }
  const float* below_contradiction(std::size_t channel, int y) const {
    return below_contradictions_[channel].row(y - begin_);
  }

  /// Of a half: how far the other half should trust its own means and differences: one over the variances of
  /// these, as estimated from this half, in luminance. 0 where one of the halves has none.
  ///
  /// Estimates come from how smooth the image is. A mean and a difference say the same of two pixels, but for
  /// the samples in which these were in different tiles; so what they contradict each other tells the
  /// variance of the means. That of differences is at most how much they vary among neighbours.
  void find_weights(int other_half, PixelCouplings& weights);

  /// Weights of both halves as one: their numbers of samples, times a constant that holds for all pixels.
  void count_weights(PixelCouplings& weights) const;

 private:
  using Term = DifferenceSums::Term;

  /// Of each pixel of a row: the number, sum and sum of squares of the differences of 3x3 pixels.
  struct Neighbourhood {
    std::vector<float> columns[3], sums[3];
    explicit Neighbourhood(int width);
    void add_up(const HalfStrip& strip, const PixelPlane& differences, int y, Term term);
  };

  /// Of the columns of a row of blocks.
  struct BlockSums {
    /// The sum over its pixels, their number; the sum of squares over its pairs, and their number.
    enum Column { luminance, pixels, contradictions, pairs };
    std::vector<float> columns[4];
    explicit BlockSums(int width);
    void add_row(int width, bool any_below, const std::uint32_t* here, const std::uint32_t* there,
                 const float* own, const float* next, const float* right, const float* below);
  };

  void read_difference(int y, Term term, PixelPlane& luminances);
  void find_blocks(int y0);
  void write_weights(int y, int other_half, PixelCouplings& weights);

  const DifferenceSums& sums_;
  int half_, w_, h_;
  int begin_ = 0, end_ = 0;
  RowMeans here_, above_, difference_;
  PixelPlane own_, right_, below_;  ///< luminances, from the row above the strip to the one below it
  PixelPlanes right_contradictions_, below_contradictions_;
  Neighbourhood around_;
  BlockSums blocks_;
  /// Of the pixels of a row: the weight of a mean, and what has the weight of no difference less variance.
  std::vector<float> screen_, least_, known_;
  std::vector<float> weights_;  ///< of a row, not yet rounded
};

}  // namespace castray
