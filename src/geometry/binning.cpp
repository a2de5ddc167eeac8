#include "geometry/binning.h"

namespace castray {
namespace {

/// Half areas of three boxes, one a lane.
__m128 half_areas(const Bounds (&box)[3]) {
  __m128 x = _mm_sub_ps(box[0].upper, box[0].lower);
  __m128 y = _mm_sub_ps(box[1].upper, box[1].lower);
  __m128 z = _mm_sub_ps(box[2].upper, box[2].lower);
  __m128 w = _mm_setzero_ps();
  _MM_TRANSPOSE4_PS(x, y, z, w);
  return _mm_add_ps(_mm_mul_ps(x, y), _mm_mul_ps(z, _mm_add_ps(x, y)));
}

__m128 blocks(__m128i count, int block_log2) {
  const __m128i whole = _mm_add_epi32(count, _mm_set1_epi32((1 << block_log2) - 1));
  return _mm_cvtepi32_ps(_mm_srli_epi32(whole, block_log2));
}

}  // namespace

Split Bins::best_split(int block_log2) const {
  const auto counts = [&](int b) { return _mm_load_si128(reinterpret_cast<const __m128i*>(count_[b])); };
  __m128 right_cost[max_bins];
  Bounds side[3];
  __m128i n = _mm_setzero_si128();
  for (int b = bins_ - 1; b > 0; --b) {
    for (int axis = 0; axis < 3; ++axis) side[axis].add(box_[b][axis]);
    n = _mm_add_epi32(n, counts(b));
    right_cost[b] = _mm_mul_ps(half_areas(side), blocks(n, block_log2));
  }

  // An empty side has infinite bounds and no primitives: its cost is NaN, and no comparison takes it.
  Split best;
  __m128 best_cost = _mm_set1_ps(best.cost), best_bin = _mm_setzero_ps();
  for (Bounds& box : side) box = Bounds();
  n = _mm_setzero_si128();
  for (int b = 1; b < bins_; ++b) {
    for (int axis = 0; axis < 3; ++axis) side[axis].add(box_[b - 1][axis]);
    n = _mm_add_epi32(n, counts(b - 1));
    const __m128 cost = _mm_add_ps(_mm_mul_ps(half_areas(side), blocks(n, block_log2)), right_cost[b]);
    const __m128 better = _mm_cmplt_ps(cost, best_cost);
    best_cost = _mm_min_ps(cost, best_cost);
    best_bin =
        _mm_or_ps(_mm_and_ps(better, _mm_set1_ps(static_cast<float>(b))), _mm_andnot_ps(better, best_bin));
  }
  const Vec3f cost = to_vec3(best_cost), bin = to_vec3(best_bin);
  for (int axis = 0; axis < 3; ++axis) {
    if (cost[axis] < best.cost) best = {axis, static_cast<int>(bin[axis]), cost[axis]};
  }
  return best;
}

}  // namespace castray
