#include "geometry/binning.h"

namespace castray {
namespace {

/// Half areas of three boxes, one a lane.
Float4 half_areas(const Bounds (&box)[3]) {
  Float4 x = box[0].upper - box[0].lower;
  Float4 y = box[1].upper - box[1].lower;
  Float4 z = box[2].upper - box[2].lower;
  Float4 w(0.f);
  transpose(x, y, z, w);
  return x * y + z * (x + y);
}

Float4 blocks(Int4 count, int block_log2) {
  return Float4((count + Int4((1 << block_log2) - 1)) >> block_log2);
}

}  // namespace

Split Bins::best_split(int block_log2) const {
  const auto counts = [&](int b) { return Int4::load(count_[b]); };
  Float4 right_cost[max_bins];
  Bounds side[3];
  Int4 n(0);
  for (int b = bins_ - 1; b > 0; --b) {
    for (int axis = 0; axis < 3; ++axis) side[axis].add(box_[b][axis]);
    n = n + counts(b);
    right_cost[b] = half_areas(side) * blocks(n, block_log2);
  }

  // An empty side has infinite bounds and no primitives: its cost is NaN, and no comparison takes it.
  Split best;
  Float4 best_cost(best.cost), best_bin(0.f);
  for (Bounds& box : side) box = Bounds();
  n = Int4(0);
  for (int b = 1; b < bins_; ++b) {
    for (int axis = 0; axis < 3; ++axis) side[axis].add(box_[b - 1][axis]);
    n = n + counts(b - 1);
    const Float4 cost = half_areas(side) * blocks(n, block_log2) + right_cost[b];
    best_bin = select_less(cost, best_cost, Float4(static_cast<float>(b)), best_bin);
    best_cost = min(cost, best_cost);
  }
  const Vec3f cost = to_vec3(best_cost), bin = to_vec3(best_bin);
  for (int axis = 0; axis < 3; ++axis) {
    if (cost[axis] < best.cost) best = {axis, static_cast<int>(bin[axis]), cost[axis]};
  }
  return best;
}

}  // namespace castray
