#include "castray/differences.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <span>

#include "core/vector_clones.h"

namespace castray {

namespace {

constexpr int columns = tile_side;
constexpr double brightest_sample = 0x1p50;  ///< in units

// A number for each column of a tile.
using Floats [[gnu::vector_size(columns * sizeof(float))]] = float;
using Doubles [[gnu::vector_size(columns * sizeof(double))]] = double;
using Longs [[gnu::vector_size(columns * sizeof(std::int64_t))]] = std::int64_t;
using Counts [[gnu::vector_size(columns * sizeof(std::uint32_t))]] = std::uint32_t;
using Bytes [[gnu::vector_size(columns)]] = std::int8_t;

// Vectors are returned in arguments: functions for several instruction sets have no one way to return them.

template <class Vector, class T>
void load(const T* from, Vector& values) {
  std::memcpy(&values, from, sizeof values);
}

template <class Vector, class T>
void store(const Vector& values, T* to) {
  std::memcpy(to, &values, sizeof values);
}

/// The nearest whole numbers, of 0 <= x < 2^51: adding 1.5 * 2^52 leaves them in the last bits.
void round_to(const Doubles& x, Longs& whole) {
  constexpr double shift = 0x1.8p52;
  const Doubles shifted = x + shift;
  std::memcpy(&whole, &shifted, sizeof whole);
  whole -= std::bit_cast<std::int64_t>(shift);
}

/// The reflected radiance of row r of a tile in channel c, in units.
void read_reflected(const TileSamples& tile, int r, int c, double per_unit, Longs& whole) {
  Floats radiance, emitted;
  load(tile.radiance[c] + r * columns, radiance);
  load(tile.emitted[c] + r * columns, emitted);
  const Floats reflected = radiance - emitted;
  const Doubles x = __builtin_convertvector(reflected > 0 ? reflected : Floats{}, Doubles) * per_unit;
  round_to(x < brightest_sample ? x : brightest_sample - Doubles{}, whole);
}

/// All ones in the columns of row r that have a bit.
void bytes_of_bits(std::uint64_t tile, int r, Bytes& bytes) {
  constexpr Bytes bit_of_column = {1, 2, 4, 8, 16, 32, 64, -128};
  bytes = (bit_of_column & static_cast<std::int8_t>(tile >> (r * columns))) != 0;
}

/// What one take of some tiles side by side gives to the pixels of the window, and which tile each has it
/// from.
class TileStrip {
 public:
  static constexpr int most_tiles = 8;

  /// (left,top): the window's first pixel in the full image.
  TileStrip(std::span<const TileSamples> tiles, int left, int top, double per_unit)
      : x_((tiles[0].x - left - tile_reach) & -columns),
        y_(tiles[0].y - top - tile_reach),
        from_x_(left + x_),
        from_y_(top + y_) {
    std::memset(tile_of_, no_tile, sizeof tile_of_);
    std::memset(kept_, 0, sizeof kept_);
    for (std::size_t k = 0; k < tiles.size(); ++k)
      for (int r = 0; r < tile_side; ++r) {
        Longs row[3];
        for (int c = 0; c < 3; ++c) read_reflected(tiles[k], r, c, per_unit, row[c]);
        if (tiles[k].ragged_x)
          put_pixels(tiles[k], static_cast<std::int8_t>(k), r, row);
        else
          put_row(tiles[k], static_cast<std::int8_t>(k), r, row);
      }
  }

  static constexpr int width = (most_tiles + 2) * columns, height = tile_side + 2 * tile_reach;
  /// Of its first column and row in the window; may lie outside.
  int x() const { return x_; }
  int y() const { return y_; }

  /// Of eight columns from `column` on: which of their samples count, and where the neighbour to the right,
  /// or below, has a sample of the same tile.
  void kept(int row, int column, Bytes& which) const { load(&kept_[row][column], which); }
  void same_tile(int row, int column, int right, int below, Bytes& which) const {
    Bytes here, there;
    load(&tile_of_[row][column], here);
    load(&tile_of_[row + below][column + right], there);
    which = here == there;
  }
  /// The values of a channel.
  void values(int channel, int row, int column, Longs& values) const {
    load(&values_[channel][row][column], values);
  }

 private:
  static constexpr std::int8_t no_tile = -1;

  void put_row(const TileSamples& tile, std::int8_t k, int r, const Longs (&row)[3]) {
    const int x = tile.x - from_x_, y = tile.y + r - from_y_;
    Bytes smooth, kept;
    bytes_of_bits(tile.smooth, r, smooth);
    bytes_of_bits(tile.kept, r, kept);
    store(k | ~smooth, &tile_of_[y][x]);
    store(smooth & kept, &kept_[y][x]);
    for (int c = 0; c < 3; ++c) store(row[c], &values_[c][y][x]);
  }

  void put_pixels(const TileSamples& tile, std::int8_t k, int r, const Longs (&row)[3]) {
    for (int i = r * columns; i < (r + 1) * columns; ++i) {
      if ((tile.smooth >> i & 1) == 0) continue;
      const int x = tile.x_of(i) - from_x_, y = tile.y_of(i) - from_y_;
      tile_of_[y][x] = k;
      kept_[y][x] = (tile.kept >> i & 1) != 0 ? -1 : 0;
      for (int c = 0; c < 3; ++c) values_[c][y][x] = row[c][i % columns];
    }
  }

  int x_, y_, from_x_, from_y_;  ///< of the first column and row, in the window and in the full image
  // one more row and column, in which no pixel has a neighbour
  std::int8_t tile_of_[height + 1][width + columns], kept_[height][width];
  std::int64_t values_[3][height + 1][width + columns];
};

/// Where a row of the window keeps the sums and counts of one term.
struct RowOfTerm {
  std::int64_t* sums;
  std::uint32_t* counts;
  int width;
  std::uint32_t takes;  ///< that they are summed as

  /// Adds values to the eight pixels from x on in which `which` is all ones: pixels of the window.
  void add(const Bytes& which, const Longs (&values)[3], int x) const {
    if (x < 0 || x + columns > width) return add_some(which, values, x);
    const Longs mask = __builtin_convertvector(which, Longs);
    Counts count;
    load(counts + x, count);
    store(count + (__builtin_convertvector(which, Counts) & takes), counts + x);
    for (int c = 0; c < 3; ++c) {
      std::int64_t* to = sums + c * width + x;
      Longs sum;
      load(to, sum);
      store(sum + (values[c] & mask), to);
    }
  }

  /// Has the memory of pixels x0 <= x < x1 come to the cache, to be written soon.
  void expect(int x0, int x1) const {
    for (int c = 0; c < 3; ++c)
      for (int x = std::max(x0, 0); x < std::min(x1, width); x += columns)
        __builtin_prefetch(sums + c * width + x, 1);
  }

 private:
  void add_some(const Bytes& which, const Longs (&values)[3], int x) const {
    for (int i = 0; i < columns; ++i) {
      if (which[i] == 0) continue;
      counts[x + i] += takes;
      for (int c = 0; c < 3; ++c) sums[c * width + x + i] += values[c][i];
    }
  }
};

}  // namespace

DifferenceSums::DifferenceSums(int width, int height, double scale)
    : kept_(true),
      width_(width),
      height_(height),
      scale_(scale),
      sums_(row(halves, 0) * channels),
      counts_(row(halves, 0)) {}

void DifferenceSums::add(std::span<const TileSamples> tiles, int y0, int y1, int left, int top) {
  for (; !tiles.empty(); tiles = tiles.subspan(std::min<std::size_t>(tiles.size(), TileStrip::most_tiles)))
    add_strip(tiles.first(std::min<std::size_t>(tiles.size(), TileStrip::most_tiles)), y0, y1, left, top);
}

CASTRAY_VECTOR_CLONES
void DifferenceSums::add_strip(std::span<const TileSamples> tiles, int y0, int y1, int left, int top) {
  const int half = static_cast<int>(tiles[0].sample & 1), takes = most_takes / tiles[0].takes;
  const TileStrip strip(tiles, left, top, takes / radiance_unit());
  const int begin = std::max(strip.y(), y0 - top), end = std::min(strip.y() + TileStrip::height, y1 - top);
  const auto row_of = [&](int y, Term term) {
    const std::size_t at = row(half, y) + place(term);
    return RowOfTerm{sums_.data() + at * channels, counts_.data() + at, width_,
                     static_cast<std::uint32_t>(takes)};
  };
  for (int y = begin; y < end; ++y) {
    const RowOfTerm of_own = row_of(y, own), of_right = row_of(y, right), of_below = row_of(y, below);
    for (const Term term : {own, right, below})
      if (y + 1 < end) row_of(y + 1, term).expect(strip.x(), strip.x() + TileStrip::width);
    const int r = y - strip.y();
    for (int column = 0; column < TileStrip::width; column += columns) {
      Bytes kept, with_right, with_below;
      strip.kept(r, column, kept);
      if (std::bit_cast<std::uint64_t>(kept) == 0) continue;
      Longs here[3], to_right[3], to_below[3];
      for (int c = 0; c < 3; ++c) {
        strip.values(c, r, column, here[c]);
        strip.values(c, r, column + 1, to_right[c]);
        strip.values(c, r + 1, column, to_below[c]);
        to_right[c] -= here[c];
        to_below[c] -= here[c];
      }
      strip.same_tile(r, column, 1, 0, with_right);
      strip.same_tile(r, column, 0, 1, with_below);
      const int x = strip.x() + column;
      of_own.add(kept, here, x);
      of_right.add(kept & with_right, to_right, x);
      of_below.add(kept & with_below, to_below, x);
    }
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
