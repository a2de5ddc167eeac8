#include "castray/differences.h"

#include <algorithm>
#include <bit>

namespace castray {

namespace {

constexpr int columns = tile_side;
constexpr unsigned all_columns = 0xff;
constexpr double brightest_sample = 0x1p50;  ///< in units

unsigned row_bits(std::uint64_t tile, int row) {
  return static_cast<unsigned>(tile >> (row * columns)) & all_columns;
}

/// The nearest whole number, of 0 <= x < 2^51: adding 1.5 * 2^52 leaves it in the last bits.
std::int64_t nearest(double x) {
  constexpr double shift = 0x1.8p52;
  return std::bit_cast<std::int64_t>(x + shift) - std::bit_cast<std::int64_t>(shift);
}

/// The reflected radiance of a tile's row, in units.
struct RowValues {
  unsigned smooth = 0;
  std::int64_t value[3][columns] = {};

  RowValues() = default;
  RowValues(const TileSamples& tile, int row, double per_unit) : smooth(row_bits(tile.smooth, row)) {
    for (int c = 0; c < 3; ++c) {
      const float *radiance = tile.radiance[c] + row * columns, *emitted = tile.emitted[c] + row * columns;
      for (int i = 0; i < columns; ++i) {
        const double reflected = std::max(radiance[i] - emitted[i], 0.f);
        value[c][i] = nearest(std::min(reflected * per_unit, brightest_sample));
      }
    }
  }
};

/// Adds `value` to sums[0..7] where there is a bit.
template <class Sum>
void add_where(unsigned bits, const Sum* value, Sum* sums) {
  if (bits == all_columns)
    for (int i = 0; i < columns; ++i) sums[i] += value[i];
  else
    for (int i = 0; i < columns; ++i)
      if (bits >> i & 1) sums[i] += value[i];
}

}  // namespace

DifferenceSums::DifferenceSums(int width, int height, double scale)
    : kept_(true),
      width_(width),
      height_(height),
      scale_(scale),
      sums_(row(halves, 0) * channels),
      counts_(row(halves, 0)) {}

void DifferenceSums::add(const TileSamples& tile, int begin, int end, int x, int y) {
  constexpr std::uint32_t ones[columns] = {1, 1, 1, 1, 1, 1, 1, 1};
  const double per_unit = 1 / radiance_unit();
  const int half = static_cast<int>(tile.sample & 1);
  RowValues here(tile, begin, per_unit);
  for (int r = begin; r < end; ++r) {
    const RowValues next = r + 1 < columns ? RowValues(tile, r + 1, per_unit) : RowValues();
    const unsigned kept = row_bits(tile.kept, r) & here.smooth;
    const unsigned added[terms] = {kept, kept & here.smooth >> 1, kept & next.smooth};
    std::uint32_t* count = counts_.data() + row(half, y + r);
    std::int64_t* sum = sums_.data() + row(half, y + r) * channels;
    for (int term = 0; kept && term < terms; ++term, count += width_) {
      add_where(added[term], ones, count + x);
      for (int c = 0; c < channels; ++c, sum += width_) {
        std::int64_t value[columns] = {};
        const std::int64_t* own_value = here.value[c];
        for (int i = 0; i < columns; ++i) value[i] = own_value[i];
        if (term == right)
          for (int i = 0; i + 1 < columns; ++i) value[i] = own_value[i + 1] - own_value[i];
        if (term == below)
          for (int i = 0; i < columns; ++i) value[i] = next.value[c][i] - own_value[i];
        add_where(added[term], value, sum + x);
      }
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
