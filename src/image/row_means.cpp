#include "image/row_means.h"

#include "core/vector_clones.h"

namespace castray {

CASTRAY_VECTOR_CLONES
void RowMeans::read(const DifferenceSums& sums, int half, int y, DifferenceSums::Term term) {
  const std::size_t width = per_sum.size();
  const std::uint32_t* count = sums.counts(half, y, term);
  const float unit = DifferenceSums::unit_over_scale;
  float* __restrict factor = per_sum.data();
  for (std::size_t x = 0; x < width; ++x) factor[x] = count[x] > 0 ? unit / static_cast<float>(count[x]) : 0;
  for (int c = 0; c < 3; ++c) {
    const std::int64_t* sum = sums.sums(half, y, term, c);
    float* __restrict out = channel[c].data();
    for (std::size_t x = 0; x < width; ++x) out[x] = static_cast<float>(sum[x]) * factor[x];
  }
}

}  // namespace castray
