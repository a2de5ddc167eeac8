#pragma once

#include <algorithm>
#include <cmath>

#include "geometry/bounds.h"

namespace castray {

/// A primitive as a builder sees it: its box, with its number in the fourth lane of `lower`.
struct PrimRef {
  __m128 lower, upper;

  PrimRef() = default;
  PrimRef(const Bounds& box, std::uint32_t id)
      : lower(_mm_or_ps(_mm_and_ps(box.lower, xyz()),
                        _mm_castsi128_ps(_mm_setr_epi32(0, 0, 0, static_cast<int>(id))))),
        upper(_mm_and_ps(box.upper, xyz())) {}

  std::uint32_t id() const {
    return static_cast<std::uint32_t>(_mm_cvtsi128_si32(_mm_shuffle_epi32(_mm_castps_si128(lower), 0xff)));
  }
  /// Twice the box's centre; the fourth lane is 0.
  __m128 centroid2() const { return _mm_add_ps(_mm_and_ps(lower, xyz()), upper); }

 private:
  static __m128 xyz() { return _mm_castsi128_ps(_mm_setr_epi32(-1, -1, -1, 0)); }
};

inline constexpr int max_bins = 32;

/// Maps primitives to bins of equal width over the range of their centroids, on each axis.
class BinMap {
 public:
  BinMap(const Bounds& centroids2, std::uint32_t count)
      : bins_(std::min(max_bins, 16 + static_cast<int>(count / 4))), origin_(centroids2.lower) {
    const Vec3f extent = to_vec3(_mm_sub_ps(centroids2.upper, centroids2.lower));
    const auto scale = [&](float e) {
      const float s = static_cast<float>(bins_) * 0.99999f / e;
      return e > 0 && std::isfinite(s) ? s : 0;
    };
    scale_ = _mm_setr_ps(scale(extent.x), scale(extent.y), scale(extent.z), 0);
  }

  int bins() const { return bins_; }
  /// No axis can be split.
  bool is_degenerate() const { return (_mm_movemask_ps(_mm_cmpgt_ps(scale_, _mm_setzero_ps())) & 7) == 0; }

  /// The bin on each axis. NaN, of overflowing centroids, goes to bin 0.
  __m128i operator()(const PrimRef& ref) const {
    const __m128 position = _mm_mul_ps(_mm_sub_ps(ref.centroid2(), origin_), scale_);
    const __m128 last = _mm_set1_ps(static_cast<float>(bins_ - 1));
    return _mm_cvttps_epi32(_mm_min_ps(_mm_max_ps(position, _mm_setzero_ps()), last));
  }

  int bin_on(int axis, const PrimRef& ref) const {
    alignas(16) int lanes[4];
    _mm_store_si128(reinterpret_cast<__m128i*>(lanes), (*this)(ref));
    return lanes[axis];
  }

 private:
  int bins_;
  __m128 origin_, scale_;
};

/// Where to cut: bins below `bin` on `axis` go left. Not valid if nothing is worth a cut.
struct Split {
  int axis = -1;
  int bin = 0;
  float cost = std::numeric_limits<float>::infinity();  ///< sum of half area times blocks of both sides

  bool is_valid() const { return axis >= 0; }
};

/// Boxes and numbers of the primitives in each bin of each axis.
class Bins {
 public:
  explicit Bins(int bins) : bins_(bins) {}

  void add(const BinMap& map, const PrimRef* begin, const PrimRef* end) {
    for (const PrimRef* p = begin; p != end; ++p) {
      alignas(16) int bin[4];
      _mm_store_si128(reinterpret_cast<__m128i*>(bin), map(*p));
      for (int axis = 0; axis < 3; ++axis) {
        box_[bin[axis]][axis].add(p->lower, p->upper);
        ++count_[bin[axis]][axis];
      }
    }
  }

  void add(const Bins& other) {
    for (int b = 0; b < bins_; ++b) {
      for (int axis = 0; axis < 3; ++axis) {
        box_[b][axis].add(other.box_[b][axis]);
        count_[b][axis] += other.count_[b][axis];
      }
    }
  }

  /// The cut of least cost. The three axes are swept side by side, one in each lane.
  Split best_split(int block_log2) const;

  /// The boxes of both sides of a cut.
  void sides(const Split& split, Bounds& left, Bounds& right) const {
    for (int b = 0; b < bins_; ++b) (b < split.bin ? left : right).add(box_[b][split.axis]);
  }

 private:
  int bins_;
  Bounds box_[max_bins][3];
  alignas(16) std::int32_t count_[max_bins][4] = {};
};

}  // namespace castray
