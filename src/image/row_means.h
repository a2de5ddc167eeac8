#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "castray/differences.h"

namespace castray {

/// Stands for both halves of a film's samples where a half is asked for.
inline constexpr int both_halves = DifferenceSums::halves;

/// The numbers of takes of a row's pixels, or differences: those of a half, or of both.
struct RowCounts {
  RowCounts(const DifferenceSums& sums, int half, int y, DifferenceSums::Term term)
      : first(sums.counts(half == both_halves ? 0 : half, y, term)),
        second(sums.counts(1, y, term)),
        second_counts(half == both_halves ? ~0u : 0u) {}
  std::uint32_t operator[](int x) const { return first[x] + (second[x] & second_counts); }

  const std::uint32_t *first, *second;
  std::uint32_t second_counts;  ///< a mask
};

/// The means of a row's pixels, or differences, in three channels, over the film's scale: reconstruction
/// squares them, which in other units might leave the range of floats.
struct RowMeans {
  std::vector<double> channel[3];
  std::vector<double> per_sum;  ///< the unit over the count, 0 without samples

  explicit RowMeans(int width) : per_sum(static_cast<std::size_t>(width)) {
    for (auto& values : channel) values.resize(static_cast<std::size_t>(width));
  }

  /// Of a half, or of both.
  void read(const DifferenceSums& sums, int half, int y, DifferenceSums::Term term);
  void find_luminance(float* luminances) const;
};

}  // namespace castray
