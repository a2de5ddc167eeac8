#include "image/pair_weights.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "castray/vec.h"
#include "core/vector_clones.h"

namespace castray {

namespace {

using Term = DifferenceSums::Term;

constexpr int block = 8;  ///< side in pixels of the areas in which the variance of means is one
/// Of its errors, a pixel's mean shares most with its tile: how much its weight is less for that.
constexpr float weight_of_mean = 0.25f;
/// A pair is in one tile in seven of eight samples, so contradictions have a quarter of the means' variance.
constexpr float means_per_contradiction = 4;
/// Of the square of a difference, what may be noise: at an edge, few samples may all have missed one side.
constexpr float doubt = 0.3f;
/// The least noise of a difference, and of a mean, over the luminance around, and over the film's scale.
constexpr float least_of_difference = 1e-3f, least_of_mean = 1e-4f, least_of_scale = 1e-8f;
/// The most that a pair weighs more than a mean, so that corrections reach some twenty pixels and not much
/// further: where few samples tell the weights, differences that are trusted too much add up along the way.
constexpr float stiffest = 512;

float square(float x) { return x * x; }

/// The luminance of the mean of a term, over the film's scale, 0 without samples, of row y.
CASTRAY_VECTOR_CLONES
void read_luminance(const DifferenceSums& sums, int half, int y, Term term, float* out) {
  const std::int64_t *red = sums.sums(half, y, term, 0), *green = sums.sums(half, y, term, 1),
                     *blue = sums.sums(half, y, term, 2);
  const std::uint32_t* count = sums.counts(half, y, term);
  const float unit = DifferenceSums::unit_over_scale;
  for (int x = 0; x < sums.width(); ++x) {
    const Vec3f sum{static_cast<float>(red[x]), static_cast<float>(green[x]), static_cast<float>(blue[x])};
    out[x] = count[x] > 0 ? luminance(sum) * (unit / static_cast<float>(count[x])) : 0;
  }
}

/// What is known of a block of pixels.
struct Block {
  float luminance2 = 0;     ///< the square of the mean luminance
  float mean_variance = 0;  ///< of a pixel's mean
};

class Weights {
 public:
  Weights(const DifferenceSums& sums, int half, int threads, PixelPlanes& luminances)
      : sums_(sums),
        half_(half),
        threads_(threads),
        w_(sums.width()),
        h_(sums.height()),
        own_(luminances[Term::own]),
        right_(luminances[Term::right]),
        below_(luminances[Term::below]),
        block_columns_((w_ + block - 1) / block),
        blocks_(static_cast<std::size_t>(block_columns_) *
                static_cast<std::size_t>((h_ + block - 1) / block)) {}

  void find(PixelCouplings& weights) {
#pragma omp parallel for schedule(static) num_threads(threads_)
    for (int y = 0; y < h_; ++y) {
      read_luminance(sums_, half_, y, Term::own, own_.row(y));
      read_luminance(sums_, half_, y, Term::right, right_.row(y));
      read_luminance(sums_, half_, y, Term::below, below_.row(y));
    }
#pragma omp parallel num_threads(threads_)
    {
      Neighbourhood around(w_);
#pragma omp for schedule(static)
      for (int y0 = 0; y0 < h_; y0 += block) {
        find_blocks(y0);
        spread_blocks(y0, around);
        for (int y = y0; y < std::min(y0 + block, h_); ++y) {
          write_screen(sums_.counts(half_, y, Term::own), w_, around.screen.data(), weights.screen.row(y));
          around.add_up(right_, sums_, half_, y, Term::right);
          write_pairs(w_ - 1, around, right_.row(y), sums_.counts(half_, y, Term::right),
                      weights.screen.row(y), weights.right.row(y));
          if (y + 1 == h_) {
            std::fill_n(weights.below.row(y), w_, 0.f);
            continue;
          }
          around.add_up(below_, sums_, half_, y, Term::below);
          write_pairs(w_, around, below_.row(y), sums_.counts(half_, y, Term::below), weights.screen.row(y),
                      weights.below.row(y));
        }
      }
    }
  }

 private:
  /// Of each pixel of a row: the number, sum and sum of squares of the differences of 3x3 pixels.
  struct Neighbourhood {
    std::vector<float> columns[3], sums[3];
    std::vector<float> screen,
        least;  ///< of its block: the weight of a mean, the least variance of differences

    explicit Neighbourhood(int width)
        : screen(static_cast<std::size_t>(width)), least(static_cast<std::size_t>(width)) {
      for (int k = 0; k < 3; ++k) {
        columns[k].resize(static_cast<std::size_t>(width) + 2);
        sums[k].resize(static_cast<std::size_t>(width));
      }
    }

    CASTRAY_VECTOR_CLONES
    void add_up(const PixelPlane& plane, const DifferenceSums& of, int half, int y, Term term) {
      for (auto& column : columns) std::fill(column.begin(), column.end(), 0.f);
      for (int row = std::max(y - 1, 0); row < std::min(y + 2, of.height()); ++row) {
        const float* difference = plane.row(row);
        const std::uint32_t* count = of.counts(half, row, term);
        float *n = &columns[0][1], *sum = &columns[1][1], *squares = &columns[2][1];
        for (int x = 0; x < of.width(); ++x) {
          n[x] += count[x] > 0 ? 1.f : 0.f;
          sum[x] += difference[x];
          squares[x] += difference[x] * difference[x];
        }
      }
      for (int k = 0; k < 3; ++k) {
        const float* column = columns[k].data();
        for (std::size_t x = 0; x < sums[k].size(); ++x)
          sums[k][x] = column[x] + column[x + 1] + column[x + 2];
      }
    }
  };

  const Block& block_at(int x, int y) const {
    return blocks_[static_cast<std::size_t>(y / block) * static_cast<std::size_t>(block_columns_) +
                   static_cast<std::size_t>(x / block)];
  }

  /// Those of rows y0 <= y < y0 + block.
  void find_blocks(int y0) {
    for (int column = 0; column < block_columns_; ++column) {
      float luminance = 0, pixels = 0, contradictions = 0, pairs = 0;
      const int x0 = column * block, x1 = std::min(x0 + block, w_);
      for (int y = y0; y < std::min(y0 + block, h_); ++y) {
        const std::uint32_t *here = sums_.counts(half_, y, Term::own),
                            *there = sums_.counts(half_, std::min(y + 1, h_ - 1), Term::own);
        const float *own = own_.row(y), *next = own_.row(y + 1), *right = right_.row(y),
                    *below = below_.row(y);
        for (int x = x0; x < x1; ++x) {
          if (here[x] == 0) continue;
          luminance += own[x], ++pixels;
          if (x + 1 < w_ && here[x + 1] > 0)
            contradictions += square(own[x + 1] - own[x] - right[x]), ++pairs;
          if (y + 1 < h_ && there[x] > 0) contradictions += square(next[x] - own[x] - below[x]), ++pairs;
        }
      }
      const float luminance2 = square(luminance / std::max(pixels, 1.f));
      const float contradiction = contradictions / std::max(pairs, 1.f);
      blocks_[static_cast<std::size_t>(y0 / block * block_columns_ + column)] = {
          luminance2, std::max(means_per_contradiction * contradiction,
                               square(least_of_mean) * luminance2 + square(least_of_scale))};
    }
  }

  /// What the pixels of rows y0 <= y < y0 + block have from their blocks.
  void spread_blocks(int y0, Neighbourhood& around) const {
    for (int x0 = 0; x0 < w_; x0 += block) {
      const Block& of_pixels = block_at(x0, y0);
      for (int x = x0; x < std::min(x0 + block, w_); ++x) {
        around.screen[static_cast<std::size_t>(x)] = weight_of_mean / of_pixels.mean_variance;
        around.least[static_cast<std::size_t>(x)] = square(least_of_difference) * of_pixels.luminance2;
      }
    }
  }

  CASTRAY_VECTOR_CLONES
  static void write_screen(const std::uint32_t* count, int width, const float* known,
                           float* __restrict screen) {
    for (int x = 0; x < width; ++x) screen[x] = count[x] > 0 ? known[x] : 0;
  }

  /// The variance of the differences of a row's first `pairs` pixels, to neighbours in the film: that among
  /// 3x3 of them, or how far this one is from their mean.
  CASTRAY_VECTOR_CLONES
  static void write_pairs(int pairs, const Neighbourhood& around, const float* difference,
                          const std::uint32_t* count, const float* screen, float* __restrict weight) {
    const float *numbers = around.sums[0].data(), *sums = around.sums[1].data(),
                *squares = around.sums[2].data(), *least = around.least.data();
    for (int x = 0; x < pairs; ++x) {
      const float n = numbers[x], mean = sums[x] / n, mean_square = squares[x] / n;
      const float among = at_least(mean_square - mean * mean, 0) * n / (n - 1),
                  own = square(difference[x] - mean);
      const float doubtful =
          doubt * at_least(mean_square, square(difference[x])) + least[x] + square(least_of_scale);
      const float variance = at_least(among, own) + doubtful / static_cast<float>(count[x]);
      const float trusted = 1 / variance, most = stiffest * screen[x];
      const float found = most < trusted ? most : trusted;
      weight[x] = ((count[x] > 0) & (n >= 2)) ? found : 0;
    }
  }

  static float at_least(float x, float least) { return x < least ? least : x; }

  const DifferenceSums& sums_;
  int half_, threads_, w_, h_;
  PixelPlane &own_, &right_, &below_;  ///< luminances of means
  int block_columns_;
  std::vector<Block> blocks_;
};

}  // namespace

void find_weights(const DifferenceSums& sums, int half, int threads, PixelPlanes& luminances,
                  PixelCouplings& weights) {
  Weights(sums, half, threads, luminances).find(weights);
}

}  // namespace castray
