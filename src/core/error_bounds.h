#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "castray/vec.h"

namespace castray {

/// Bound of the relative error of n roundings (Higham 2002, lemma 3.1).
template <class T>
constexpr T gamma_bound(int n) {
  constexpr T half_ulp = std::numeric_limits<T>::epsilon() / 2;
  return static_cast<T>(n) * half_ulp / (T(1) - static_cast<T>(n) * half_ulp);
}

template <class T>
Vec3<T> magnitude(const Vec3<T>& v) {
  return {std::abs(v.x), std::abs(v.y), std::abs(v.z)};
}

/// Bound, per coordinate, of the error that a ray/triangle test adds for a triangle up to `distance` from the
/// ray's origin: translating and shearing a vertex (TriangleTest) rounds up to 4 times, in two axes, terms of
/// at most twice that distance; interpolating the depth adds some more.
template <class T>
Vec3<T> error_of_test(T distance) {
  return Vec3<T>(distance * gamma_bound<T>(24));
}

/// A point on a triangle where a ray starts or ends. `error` bounds, per coordinate, the point's distance by
/// rounding from the plane in which a ray/triangle test finds the triangle.
template <class T>
struct TrianglePoint {
  Vec3<T> p, error;
};

/// Interpolation errs by 7 roundings of sum |b_i v_i| (Pharr et al., Physically Based Rendering, "Managing
/// rounding error"). Without the test's own error, triangles in the plane of an axis, where interpolation is
/// exact, would shadow themselves.
template <class T>
TrianglePoint<T> point_on_triangle(const Vec3<T>& v0, const Vec3<T>& v1, const Vec3<T>& v2, T b1, T b2) {
  const T b0 = T(1) - b1 - b2;
  const Vec3<T> a = v0 * b0, b = v1 * b1, c = v2 * b2;
  const T extent = std::max(max_component(magnitude(v1 - v0)), max_component(magnitude(v2 - v0)));
  return {a + b + c,
          (magnitude(a) + magnitude(b) + magnitude(c)) * gamma_bound<T>(7) + error_of_test(extent)};
}

/// The number next to a finite `x`, above or below; std::nextafter, inline.
template <class T>
T neighbour(T x, bool above) {
  using Bits = std::conditional_t<sizeof(T) == 4, std::int32_t, std::int64_t>;
  if (x == 0) return above ? std::numeric_limits<T>::denorm_min() : -std::numeric_limits<T>::denorm_min();
  const Bits bits = std::bit_cast<Bits>(x);
  return std::bit_cast<T>(bits + ((x > 0) == above ? 1 : -1));
}

/// The origin of a ray that leaves a surface on the side of `direction`: `p` pushed along the unit normal by
/// the projection of its error bound, each coordinate rounded one step outward. Never on the other side of
/// the surface, and no further away than rounding requires (Pharr et al., Physically Based Rendering,
/// "Robust spawned ray origins").
template <class T>
Vec3<T> offset_origin(const Vec3<T>& p, const Vec3<T>& error, const Vec3<T>& normal,
                      const Vec3<T>& direction) {
  const T distance = dot(magnitude(normal), error);
  const Vec3<T> push = normal * (dot(direction, normal) < 0 ? -distance : distance);
  const auto outward = [](T q, T step) { return step == 0 ? q : neighbour(q, step > 0); };
  return {outward(p.x + push.x, push.x), outward(p.y + push.y, push.y), outward(p.z + push.z, push.z)};
}

}  // namespace castray
