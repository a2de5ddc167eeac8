#pragma once

#include <cmath>
#include <limits>

#include "geometry/ray.h"

namespace castray {

/// A ray prepared for boxes. Conservative: passes every box that holds a triangle that TriangleTest accepts,
/// at an entry distance no greater than that triangle's t.
///
/// TriangleTest moves a vertex along an axis by at most 2u|X| + 4u|S||Z|, and its t errs by 12u|Z|, which
/// moves the ray's point by |S| of that (u half an ulp; X, Z the distances of the farthest vertex from the
/// origin along this axis and along the main one; S what the ray moves along this axis for a step along the
/// main one): together less than 3u|X| + 17u|S||Z|, by which every box grows. That, and the rounding of the
/// slab's own arithmetic, 1 + 2 gamma(3), costs nothing per box: it is put into the origin and the reciprocal
/// direction, which differ for near and far planes. Woop, Benthin, Wald (2013), section 3.3; Ize (2013).
template <class T>
class SlabTest {
 public:
  SlabTest(const Ray<T>& ray, int main_axis, const Vec3f& lower, const Vec3f& upper) {
    constexpr T u = std::numeric_limits<T>::epsilon() / 2, rounding = 2 * (3 * u / (1 - 3 * u));
    const auto reach = [&](int i) {
      const T o = ray.origin[i];
      return std::max(std::abs(T(lower[i]) - o), std::abs(T(upper[i]) - o));
    };
    const T size = std::abs(ray.direction[main_axis]), reach_t = reach(main_axis) / size;
    for (int i = 0; i < 3; ++i) {
      const T inverse = 1 / ray.direction[i];
      negative_[i] = std::signbit(inverse);
      const T grow =
          3 * u * reach(i) + 17 * u * std::abs(ray.direction[i]) * reach_t + 4 * u * std::abs(ray.origin[i]);
      near_origin_[i] = ray.origin[i] + (negative_[i] ? -grow : grow);
      far_origin_[i] = ray.origin[i] - (negative_[i] ? -grow : grow);
      near_inverse_[i] = inverse * (1 - rounding);
      far_inverse_[i] = inverse * (1 + rounding);
    }
  }

  /// Whether the ray meets the box before `t_max` (inclusive), and where it enters, at least 0. NaN, from 0
  /// times infinity, never discards: a comparison with it keeps the bound so far.
  bool intersect(const float* lower, const float* upper, T t_max, T& t_near) const {
    T near = 0, far = t_max;
    for (int i = 0; i < 3; ++i) {
      const float* const near_plane = negative_[i] ? upper : lower;
      const float* const far_plane = negative_[i] ? lower : upper;
      const T enter = (T(near_plane[i]) - near_origin_[i]) * near_inverse_[i];
      const T leave = (T(far_plane[i]) - far_origin_[i]) * far_inverse_[i];
      near = enter > near ? enter : near;
      far = leave < far ? leave : far;
    }
    t_near = near;
    return near <= far;
  }

 private:
  T near_origin_[3], far_origin_[3], near_inverse_[3], far_inverse_[3];
  bool negative_[3];
};

}  // namespace castray
