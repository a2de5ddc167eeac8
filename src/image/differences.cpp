#include "castray/differences.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "castray/vec.h"
#include "core/contract.h"

namespace castray {

namespace {

constexpr int columns = tile_side;
constexpr double brightest_sample = 0x1p50;  ///< in units

/// Bits of the pixels that have a neighbour on a side, in their tile.
struct Neighbours {
  std::uint64_t left, right, above, below;

  explicit Neighbours(std::uint64_t valid) {
    constexpr std::uint64_t first_column = 0x0101010101010101u, last_column = first_column << 7;
    left = (valid & ~last_column) << 1;
    right = (valid & ~first_column) >> 1;
    above = valid << columns;
    below = valid >> columns;
  }
};

/// Of the pixels in a tile's row.
struct RowValues {
  std::array<float, columns> radiance[3];  ///< reflected
  std::array<float, columns> root;         ///< of its luminance

  RowValues(const TileSamples& tile, int row) {
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t i = 0; i < columns; ++i) {
        const std::size_t at = static_cast<std::size_t>(row * columns) + i;
        radiance[c][i] = std::max(tile.radiance[c][at] - tile.emitted[c][at], 0.f);
      }
    for (std::size_t i = 0; i < columns; ++i)
      root[i] = std::sqrt(luminance(Vec3f(radiance[0][i], radiance[1][i], radiance[2][i])));
  }
};

std::uint32_t dice_of(const TileSamples& tile, int row, int column) {
  const auto x = static_cast<std::uint32_t>(tile.x + column), y = static_cast<std::uint32_t>(tile.y + row);
  return hash_combine(static_cast<std::uint32_t>(tile.sample), (y << 16) ^ x);
}

/// Rounds up with the probability of the fraction, by ten bits of `dice`.
std::int64_t rounded(double value, std::uint32_t dice) {
  return static_cast<std::int64_t>(std::min(value, brightest_sample) + ((dice & 1023u) + 0.5) / 1024);
}

void add_to(std::int64_t (&sum)[3], const std::array<std::int64_t, 3>& value) {
  for (std::size_t c = 0; c < 3; ++c) sum[c] += value[c];
}

}  // namespace

double DifferenceSums::root_unit() const { return std::sqrt(scale_) * 0x1p-36; }

void DifferenceSums::add(const TileSamples& tile, int row, std::ptrdiff_t first) {
  const Neighbours has(tile.valid);
  const RowValues here(tile, row), next(tile, std::min(row + 1, columns - 1));
  const double per_unit = 1 / radiance_unit(), roots_per_unit = 1 / root_unit(),
               spread_per_unit = 1 / spread_unit();
  for (std::size_t column = 0; column < columns; ++column) {
    const auto in = [bit = row * columns + static_cast<int>(column)](std::uint64_t bits) {
      return (bits >> bit & 1) != 0;
    };
    if (!in(tile.kept)) continue;
    const std::uint32_t dice = dice_of(tile, row, static_cast<int>(column));
    const std::array value{rounded(here.radiance[0][column] * per_unit, dice),
                           rounded(here.radiance[1][column] * per_unit, dice >> 10),
                           rounded(here.radiance[2][column] * per_unit, dice >> 20)};
    const double root = here.root[column];
    const auto spread = [&](double neighbour) {
      const double difference = neighbour - root;
      return static_cast<std::int64_t>(difference * difference * spread_per_unit + 0.5);
    };
    const std::size_t at = place(static_cast<std::size_t>(first + static_cast<std::ptrdiff_t>(column)),
                                 static_cast<int>(tile.sample & 1));
    Pixel& sum = sums_[at];
    auto& apart = apart_[at].sum;
    ++sum.count;
    add_to(sum.all, value);
    sum.root += static_cast<std::int64_t>(root * roots_per_unit + 0.5);
    if (!in(has.left)) add_to(apart[left], value);
    if (!in(has.above)) add_to(apart[above], value);
    if (in(has.right))
      ++sum.with_right, sum.spread_right += spread(here.root[column + 1]);
    else
      add_to(apart[right], value);
    if (in(has.below))
      ++sum.with_below, sum.spread_below += spread(next.root[column]);
    else
      add_to(apart[below], value);
  }
}

void DifferenceSums::add(std::size_t to, const DifferenceSums& other, std::size_t from, std::size_t count) {
  for (int half = 0; half < halves; ++half)
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t at = place(to + i, half), there = other.place(from + i, half);
      Pixel& ours = sums_[at];
      const Pixel& theirs = other.sums_[there];
      for (int c = 0; c < 3; ++c) {
        ours.all[c] += theirs.all[c];
        for (int side = 0; side < 4; ++side) apart_[at].sum[side][c] += other.apart_[there].sum[side][c];
      }
      ours.root += theirs.root;
      ours.spread_right += theirs.spread_right;
      ours.spread_below += theirs.spread_below;
      ours.count += theirs.count;
      ours.with_right += theirs.with_right;
      ours.with_below += theirs.with_below;
    }
}

}  // namespace castray
