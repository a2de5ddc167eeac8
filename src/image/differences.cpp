#include "castray/differences.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "core/vector_clones.h"

namespace castray {

namespace {

constexpr int columns = tile_side, tile_pixels = tile_side * tile_side;
constexpr unsigned all_columns = 0xff;
constexpr double brightest_sample = 0x1p50;  ///< in units

// A number for each column of a tile.
using Floats [[gnu::vector_size(columns * sizeof(float))]] = float;
using Doubles [[gnu::vector_size(columns * sizeof(double))]] = double;
using Longs [[gnu::vector_size(columns * sizeof(std::int64_t))]] = std::int64_t;
using Counts [[gnu::vector_size(columns * sizeof(std::uint32_t))]] = std::uint32_t;

unsigned row_bits(std::uint64_t tile, int row) {
  return static_cast<unsigned>(tile >> (row * columns)) & all_columns;
}

/// The nearest whole numbers, of 0 <= x < 2^51: adding 1.5 * 2^52 leaves them in the last bits.
void round_to(const Doubles& x, Longs& whole) {
  constexpr double shift = 0x1.8p52;
  const Doubles shifted = x + shift;
  std::memcpy(&whole, &shifted, sizeof whole);
  whole -= std::bit_cast<std::int64_t>(shift);
}

/// Of a tile's row, in three channels.
struct RowValues {
  Longs channel[3] = {};
};

/// The reflected radiance of row r, in units.
void read_reflected(const TileSamples& tile, int r, double per_unit, RowValues& values) {
  for (int c = 0; c < 3; ++c) {
    Floats radiance, emitted;
    std::memcpy(&radiance, tile.radiance[c] + r * columns, sizeof radiance);
    std::memcpy(&emitted, tile.emitted[c] + r * columns, sizeof emitted);
    const Floats reflected = radiance - emitted;
    const Doubles x = __builtin_convertvector(reflected > 0 ? reflected : Floats{}, Doubles) * per_unit;
    round_to(x < brightest_sample ? x : brightest_sample - Doubles{}, values.channel[c]);
  }
}

/// Adds the columns that have a bit to the sums of pixels x to x + 7, all in the window.
void add_whole_row(const RowValues& values, unsigned bits, std::uint32_t* counts, std::int64_t* sums,
                   int width, int x) {
  constexpr Longs bit_of_column = {1, 2, 4, 8, 16, 32, 64, 128};
  const Longs mask = (bit_of_column & std::int64_t{bits}) != 0;
  const auto add = [&](auto* to, const auto& more) {
    auto sum = more;
    std::memcpy(&sum, to + x, sizeof sum);
    sum += more;
    std::memcpy(to + x, &sum, sizeof sum);
  };
  add(counts, __builtin_convertvector(-mask, Counts));
  for (int c = 0; c < 3; ++c) {
    const Longs more = values.channel[c] & mask;
    add(sums + std::ptrdiff_t{c} * width, more);
  }
}

/// The same for a row that reaches out of the window, where it has no bits.
void add_part_of_row(const RowValues& values, unsigned bits, std::uint32_t* counts, std::int64_t* sums,
                     int width, int x) {
  for (int i = 0; i < columns; ++i) {
    if ((bits >> i & 1) == 0) continue;
    ++counts[x + i];
    for (int c = 0; c < 3; ++c) sums[c * width + x + i] += values.channel[c][i];
  }
}

/// Which pixel of a ragged tile has a place.
class RaggedPlaces {
 public:
  explicit RaggedPlaces(const TileSamples& tile) : tile_(tile) {
    pixels_.fill(none);
    for (int i = 0; i < tile_pixels; ++i) pixels_[place(i)] = static_cast<std::int8_t>(i);
  }
  int column(int i) const { return tile_.x_of(i) - tile_.x; }
  int row(int i) const { return tile_.y_of(i) - tile_.y; }

  static constexpr int none = -1;
  int right_of(int i) const { return pixels_[place(i) + 1]; }
  int below(int i) const { return pixels_[place(i) + stride]; }

 private:
  static constexpr std::size_t stride = columns + 2 * tile_reach + 1;

  std::size_t place(int i) const {
    return static_cast<std::size_t>(row(i) + tile_reach) * stride +
           static_cast<std::size_t>(column(i) + tile_reach);
  }

  const TileSamples& tile_;
  std::array<std::int8_t, stride * stride> pixels_;
};

}  // namespace

DifferenceSums::DifferenceSums(int width, int height, double scale)
    : kept_(true),
      width_(width),
      height_(height),
      scale_(scale),
      sums_(row(halves, 0) * channels),
      counts_(row(halves, 0)) {}

void DifferenceSums::add(const TileSamples& tile, int begin, int end, int x, int y) {
  if (begin >= end) return;
  if (tile.ragged_x)
    add_ragged(tile, begin, end, x, y);
  else
    add_square(tile, begin, end, x, y);
}

CASTRAY_VECTOR_CLONES
void DifferenceSums::add_ragged(const TileSamples& tile, int begin, int end, int x, int y) {
  const double per_unit = 1 / radiance_unit();
  const int half = static_cast<int>(tile.sample & 1);
  const RaggedPlaces places(tile);
  RowValues rows[columns];
  for (int r = 0; r < columns; ++r) read_reflected(tile, r, per_unit, rows[r]);
  const auto value = [&](int i, int c) { return rows[i / columns].channel[c][i % columns]; };
  const auto is_smooth = [&](int i) { return i != RaggedPlaces::none && (tile.smooth >> i & 1) != 0; };
  for (int i = 0; i < tile_pixels; ++i) {
    const int r = places.row(i);
    if (r < begin || r >= end || (tile.kept >> i & 1) == 0 || !is_smooth(i)) continue;
    const auto add = [&](Term term, auto values) {
      const std::size_t at = row(half, y + r) + place(term),
                        column = static_cast<std::size_t>(x + places.column(i));
      ++counts_[at + column];
      for (int c = 0; c < channels; ++c) sums_[at * channels + place(c) + column] += values(c);
    };
    const auto add_difference = [&](Term term, int neighbour) {
      if (is_smooth(neighbour)) add(term, [&](int c) { return value(neighbour, c) - value(i, c); });
    };
    add(own, [&](int c) { return value(i, c); });
    add_difference(right, places.right_of(i));
    add_difference(below, places.below(i));
  }
}

CASTRAY_VECTOR_CLONES
void DifferenceSums::add_square(const TileSamples& tile, int begin, int end, int x, int y) {
  const double per_unit = 1 / radiance_unit();
  const int half = static_cast<int>(tile.sample & 1);
  const bool inside = x >= 0 && x + columns <= width_;
  RowValues here, next, difference;
  read_reflected(tile, begin, per_unit, here);
  for (int r = begin; r < end; ++r) {
    const bool last = r + 1 == columns;
    if (!last) read_reflected(tile, r + 1, per_unit, next);
    const unsigned smooth = row_bits(tile.smooth, r), kept = row_bits(tile.kept, r) & smooth,
                   smooth_below = last ? 0 : row_bits(tile.smooth, r + 1);
    const auto add = [&](Term term, const RowValues& values, unsigned bits) {
      const std::size_t at = row(half, y + r) + place(term);
      std::uint32_t* counts = counts_.data() + at;
      std::int64_t* sums = sums_.data() + at * channels;
      if (inside)
        add_whole_row(values, bits, counts, sums, width_, x);
      else
        add_part_of_row(values, bits, counts, sums, width_, x);
    };
    if (kept) {
      add(own, here, kept);
      for (int c = 0; c < 3; ++c)
        difference.channel[c] =
            __builtin_shufflevector(here.channel[c], here.channel[c], 1, 2, 3, 4, 5, 6, 7, 7) -
            here.channel[c];
      add(right, difference, kept & smooth >> 1);
      for (int c = 0; c < 3; ++c) difference.channel[c] = next.channel[c] - here.channel[c];
      add(below, difference, kept & smooth_below);
    }
    here = next;
  }
}

void DifferenceSums::add_row(int x, int y, const DifferenceSums& other, int other_x, int other_y, int count) {
  for (int half = 0; half < halves; ++half)
    for (int term = 0; term < terms; ++term) {
      const std::uint32_t* counts = other.counts(half, other_y, static_cast<Term>(term)) + other_x;
      std::uint32_t* our_counts = &counts_[row(half, y) + place(term)] + x;
      for (int i = 0; i < count; ++i) our_counts[i] += counts[i];
      for (int c = 0; c < channels; ++c) {
        const std::int64_t* sums = other.sums(half, other_y, static_cast<Term>(term), c) + other_x;
        std::int64_t* ours = &sums_[row(half, y) * channels + place(term * channels + c)] + x;
        for (int i = 0; i < count; ++i) ours[i] += sums[i];
      }
    }
}

}  // namespace castray
