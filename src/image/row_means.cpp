#include "image/row_means.h"

#include <limits>

#include "castray/vec.h"
#include "core/vector_clones.h"

namespace castray {

CASTRAY_VECTOR_CLONES
void RowMeans::read(const DifferenceSums& sums, int half, int y, DifferenceSums::Term term) {
  const std::size_t width = per_sum.size();
  const bool both = half == both_halves;
  const RowCounts count(sums, half, y, term);
  const double unit = DifferenceSums::unit_over_scale;
  double* __restrict factor = per_sum.data();
  constexpr double none = std::numeric_limits<double>::infinity();  // a quotient of 0, without a branch
  for (std::size_t x = 0; x < width; ++x) {
    const auto number = static_cast<double>(static_cast<std::int32_t>(count[static_cast<int>(x)]));
    factor[x] = unit / (number > 0 ? number : none);
  }
  for (int c = 0; c < 3; ++c) {
    const std::int64_t *sum = sums.sums(both ? 0 : half, y, term, c), *second_sum = sums.sums(1, y, term, c);
    double* __restrict out = channel[c].data();
    for (std::size_t x = 0; x < width; ++x)
      out[x] = static_cast<double>(sum[x] + (both ? second_sum[x] : 0)) * factor[x];
  }
}

CASTRAY_VECTOR_CLONES
void RowMeans::find_luminance(float* __restrict luminances) const {
  const double *red = channel[0].data(), *green = channel[1].data(), *blue = channel[2].data();
  for (std::size_t x = 0; x < per_sum.size(); ++x)
    luminances[x] = static_cast<float>(luminance(Vec3d(red[x], green[x], blue[x])));
}

}  // namespace castray
