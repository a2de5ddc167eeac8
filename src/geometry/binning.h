#pragma once

#include <algorithm>
#include <cmath>

#include "geometry/bounds.h"

namespace castray {

/// A primitive as a builder sees it: its box, with its number in the fourth lane of `lower`.
struct PrimRef {
  Float4 lower, upper;

  PrimRef() = default;
  PrimRef(const Bounds& box, std::uint32_t id) : lower(box.lower.with_w(id)), upper(box.upper.without_w()) {}

  std::uint32_t id() const { return lower.w_bits(); }
  /// Twice the box's centre; the fourth lane is 0.
  Float4 centroid2() const { return lower.without_w() + upper; }
};

inline constexpr int max_bins = 32;

/// Maps primitives to bins of equal width over the range of their centroids, on each axis.
class BinMap {
 public:
  BinMap(const Bounds& centroids2, std::uint32_t count)
      : bins_(std::min(max_bins, 16 + static_cast<int>(count / 4))), origin_(centroids2.lower) {
    const Vec3f extent = to_vec3(centroids2.upper - centroids2.lower);
    const auto scale = [&](float e) {
      const float s = static_cast<float>(bins_) * 0.99999f / e;
      return e > 0 && std::isfinite(s) ? s : 0;
    };
    scale_ = {scale(extent.x), scale(extent.y), scale(extent.z), 0};
  }

  int bins() const { return bins_; }
  /// No axis can be split.
  bool is_degenerate() const { return (scale_.positive_lanes() & 7) == 0; }

  /// The bin on each axis. NaN, of overflowing centroids, goes to bin 0.
  Int4 operator()(const PrimRef& ref) const {
    const Float4 position = (ref.centroid2() - origin_) * scale_;
    return min(max(position, Float4(0.f)), Float4(static_cast<float>(bins_ - 1))).truncated();
  }

  int bin_on(int axis, const PrimRef& ref) const {
    alignas(16) std::int32_t lanes[4];
    (*this)(ref).store(lanes);
    return lanes[axis];
  }

 private:
  int bins_;
  Float4 origin_, scale_;
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
      alignas(16) std::int32_t bin[4];
      map(*p).store(bin);
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
