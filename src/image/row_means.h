#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "castray/differences.h"

namespace castray {

/// The means of a row's pixels, or differences, in three channels.
struct RowMeans {
  std::vector<double> channel[3];
  std::vector<double> per_sum;  ///< the unit over the count, 0 without samples

  explicit RowMeans(int width) : per_sum(static_cast<std::size_t>(width)) {
    for (auto& values : channel) values.resize(static_cast<std::size_t>(width));
  }

  void read(const DifferenceSums& sums, int half, int y, DifferenceSums::Term term) {
    const std::uint32_t* count = sums.counts(half, y, term);
    const double unit = sums.radiance_unit();
    for (std::size_t x = 0; x < per_sum.size(); ++x) per_sum[x] = count[x] > 0 ? unit / count[x] : 0;
    for (int c = 0; c < 3; ++c) {
      const std::int64_t* sum = sums.sums(half, y, term, c);
      double* out = channel[c].data();
      for (std::size_t x = 0; x < per_sum.size(); ++x) out[x] = static_cast<double>(sum[x]) * per_sum[x];
    }
  }
};

}  // namespace castray
