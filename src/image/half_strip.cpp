#include "image/half_strip.h"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <utility>

#include "core/vector_clones.h"

namespace castray {

namespace {

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
/// How much more a sample of a difference weighs than one of a mean, where nothing else is known.
constexpr float usual_stiffness = 256;

float square(float x) { return x * x; }
float at_least(float x, float least) { return x < least ? least : x; }

/// Of a row's first `pairs` pixels.
CASTRAY_VECTOR_CLONES
void find_contradictions(int pairs, const double* difference, const double* mean, const double* neighbour,
                         float* __restrict contradiction) {
  for (int x = 0; x < pairs; ++x)
    contradiction[x] = static_cast<float>(difference[x] - (neighbour[x] - mean[x]));
}

CASTRAY_VECTOR_CLONES
void write_counts(int number, float factor, const RowCounts& count, Coupling* __restrict weight) {
  for (int x = 0; x < number; ++x) weight[x] = factor * static_cast<float>(count[x]);
}

CASTRAY_VECTOR_CLONES
void write_screen(int width, const float* screen, const std::uint32_t* other_count,
                  float* __restrict weight) {
  for (int x = 0; x < width; ++x) weight[x] = other_count[x] > 0 ? screen[x] : 0;
}

/// What is known of the pairs of a row's pixels with their neighbours on one side.
struct Pairs {
  const float *numbers, *sums, *squares;  ///< of 3x3 differences
  const float *difference, *least, *screen;
  const std::uint32_t *count, *other_count;
};

/// The variance of the first `number` differences: that among 3x3 of them, or how far this one is from their
/// mean.
CASTRAY_VECTOR_CLONES
void write_pairs(int number, const Pairs& of, float* __restrict weight) {
  for (int x = 0; x < number; ++x) {
    const float n = of.numbers[x], mean = of.sums[x] / n, mean_square = of.squares[x] / n;
    const float among = at_least(mean_square - mean * mean, 0) * n / (n - 1),
                own = square(of.difference[x] - mean);
    const float doubtful =
        doubt * at_least(mean_square, square(of.difference[x])) + of.least[x] + square(least_of_scale);
    const float samples = static_cast<float>(of.count[x]) / DifferenceSums::most_takes;
    const float variance = at_least(among, own) + doubtful / samples;
    const float trusted = 1 / variance, most = stiffest * of.screen[x];
    const float found = most < trusted ? most : trusted;
    weight[x] = ((of.count[x] > 0) & (of.other_count[x] > 0) & (n >= 2)) ? found : 0;
  }
}

CASTRAY_VECTOR_CLONES
void round_weights(int number, const float* weights, Coupling* __restrict rounded) {
  for (int x = 0; x < number; ++x) rounded[x] = weights[x];
}

}  // namespace

HalfStrip::Neighbourhood::Neighbourhood(int width) {
  for (int k = 0; k < 3; ++k) {
    columns[k].resize(static_cast<std::size_t>(width) + 2);
    sums[k].resize(static_cast<std::size_t>(width));
  }
}

CASTRAY_VECTOR_CLONES
void HalfStrip::Neighbourhood::add_up(const HalfStrip& strip, const PixelPlane& differences, int y,
                                      Term term) {
  for (auto& column : columns) std::fill(column.begin(), column.end(), 0.f);
  for (int row = std::max(y - 1, 0); row < std::min(y + 2, strip.h_); ++row) {
    const float* difference = differences.row(row - strip.begin_);
    const std::uint32_t* count = strip.sums_.counts(strip.half_, row, term);
    float *n = &columns[0][1], *sum = &columns[1][1], *squares = &columns[2][1];
    for (int x = 0; x < strip.w_; ++x) {
      n[x] += count[x] > 0 ? 1.f : 0.f;
      sum[x] += difference[x];
      squares[x] += difference[x] * difference[x];
    }
  }
  for (int k = 0; k < 3; ++k) {
    const float* column = columns[k].data();
    for (std::size_t x = 0; x < sums[k].size(); ++x) sums[k][x] = column[x] + column[x + 1] + column[x + 2];
  }
}

HalfStrip::BlockSums::BlockSums(int width) {
  for (auto& column : columns) column.resize(static_cast<std::size_t>(width));
}

CASTRAY_VECTOR_CLONES
void HalfStrip::BlockSums::add_row(int width, bool any_below, const std::uint32_t* here,
                                   const std::uint32_t* there, const float* own, const float* next,
                                   const float* right, const float* below) {
  float *__restrict luminances = columns[luminance].data(), *__restrict numbers = columns[pixels].data(),
        *__restrict squares = columns[contradictions].data(), *__restrict both = columns[pairs].data();
  for (int x = 0; x < width; ++x) {
    luminances[x] += here[x] > 0 ? own[x] : 0;
    numbers[x] += here[x] > 0 ? 1.f : 0.f;
  }
  for (int x = 0; x + 1 < width; ++x) {
    const float known = ((here[x] > 0) & (here[x + 1] > 0)) ? 1.f : 0.f;
    squares[x] += known * square(own[x + 1] - own[x] - right[x]);
    both[x] += known;
  }
  for (int x = 0; any_below && x < width; ++x) {
    const float known = ((here[x] > 0) & (there[x] > 0)) ? 1.f : 0.f;
    squares[x] += known * square(next[x] - own[x] - below[x]);
    both[x] += known;
  }
}

HalfStrip::HalfStrip(const DifferenceSums& sums, int half)
    : sums_(sums),
      half_(half),
      w_(sums.width()),
      h_(sums.height()),
      here_(w_),
      above_(w_),
      difference_(w_),
      own_(w_, rows + 1),
      right_(w_, rows + 1),
      below_(w_, rows + 1),
      around_(w_),
      blocks_(w_),
      screen_(static_cast<std::size_t>(w_)),
      least_(screen_),
      known_(screen_),
      weights_(screen_) {
  for (PixelPlanes* planes : {&right_contradictions_, &below_contradictions_})
    for (PixelPlane& plane : *planes) plane = PixelPlane(w_, rows);
}

void HalfStrip::read_difference(int y, Term term, PixelPlane& luminances) {
  difference_.read(sums_, half_, y, term);
  difference_.find_luminance(luminances.row(y - begin_));
}

void HalfStrip::read(int begin) {
  begin_ = begin;
  end_ = std::min(begin + rows, h_);
  const int first = std::max(begin - 1, 0), last = std::min(end_, h_ - 1);
  for (int y = first; y <= last; ++y) {
    std::swap(here_, above_);
    here_.read(sums_, half_, y, Term::own);
    here_.find_luminance(own_.row(y - begin_));
    read_difference(y, Term::right, right_);
    for (std::size_t c = 0; c < 3 && y >= begin_ && y < end_; ++c)
      find_contradictions(w_ - 1, difference_.channel[c].data(), here_.channel[c].data(),
                          here_.channel[c].data() + 1, right_contradictions_[c].row(y - begin_));
    if (y == first) continue;
    read_difference(y - 1, Term::below, below_);
    for (std::size_t c = 0; c < 3 && y > begin_; ++c)
      find_contradictions(w_, difference_.channel[c].data(), above_.channel[c].data(),
                          here_.channel[c].data(), below_contradictions_[c].row(y - 1 - begin_));
  }
  read_difference(last, Term::below, below_);
}

void HalfStrip::find_weights(int other_half, PixelCouplings& weights) {
  for (int y = begin_; y < end_; ++y) {
    if (y % block == 0) find_blocks(y);
    write_weights(y, other_half, weights);
  }
}

void HalfStrip::count_weights(PixelCouplings& weights) const {
  const auto write = [&](int y, Term term, float factor, int number, CouplingPlane& plane) {
    write_counts(number, factor, RowCounts(sums_, both_halves, y, term), plane.row(y));
  };
  for (int y = begin_; y < end_; ++y) {
    write(y, Term::own, 1, w_, weights.screen);
    write(y, Term::right, usual_stiffness, w_ - 1, weights.right);
    if (y + 1 < h_) write(y, Term::below, usual_stiffness, w_, weights.below);
  }
}

/// What the pixels of rows y0 <= y < y0 + block have from their blocks.
void HalfStrip::find_blocks(int y0) {
  for (auto& column : blocks_.columns) std::fill(column.begin(), column.end(), 0.f);
  for (int y = y0; y < std::min(y0 + block, h_); ++y) {
    const bool any_below = y + 1 < h_;
    const int here = y - begin_, there = any_below ? here + 1 : here;
    blocks_.add_row(w_, any_below, sums_.counts(half_, y, Term::own),
                    sums_.counts(half_, begin_ + there, Term::own), own_.row(here), own_.row(there),
                    right_.row(here), below_.row(here));
  }
  for (int x0 = 0; x0 < w_; x0 += block) {
    const int x1 = std::min(x0 + block, w_);
    const auto total = [&](BlockSums::Column column) {
      const auto& values = blocks_.columns[column];
      return std::accumulate(values.begin() + x0, values.begin() + x1, 0.f);
    };
    const float luminance2 = square(total(BlockSums::luminance) / std::max(total(BlockSums::pixels), 1.f));
    const float contradiction = total(BlockSums::contradictions) / std::max(total(BlockSums::pairs), 1.f);
    const float mean_variance = std::max(means_per_contradiction * contradiction,
                                         square(least_of_mean) * luminance2 + square(least_of_scale));
    std::fill(screen_.begin() + x0, screen_.begin() + x1, weight_of_mean / mean_variance);
    std::fill(least_.begin() + x0, least_.begin() + x1, square(least_of_difference) * luminance2);
  }
}

void HalfStrip::write_weights(int y, int other_half, PixelCouplings& weights) {
  const std::uint32_t* count = sums_.counts(half_, y, Term::own);
  write_screen(w_, screen_.data(), count, known_.data());
  write_screen(w_, known_.data(), sums_.counts(other_half, y, Term::own), weights_.data());
  round_weights(w_, weights_.data(), weights.screen.row(y));
  const auto write = [&](Term term, const PixelPlane& differences, int number, Coupling* rounded) {
    around_.add_up(*this, differences, y, term);
    write_pairs(
        number,
        {around_.sums[0].data(), around_.sums[1].data(), around_.sums[2].data(), differences.row(y - begin_),
         least_.data(), known_.data(), sums_.counts(half_, y, term), sums_.counts(other_half, y, term)},
        weights_.data());
    round_weights(number, weights_.data(), rounded);
  };
  write(Term::right, right_, w_ - 1, weights.right.row(y));
  if (y + 1 < h_) write(Term::below, below_, w_, weights.below.row(y));
}

}  // namespace castray
