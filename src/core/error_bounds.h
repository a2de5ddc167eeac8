#pragma once

#include <cmath>
#include <limits>

#include "castray/vec.h"

namespace castray {

/// Bound of the relative error of n roundings (Higham 2002, lemma 3.1).
template <class T>
constexpr T gamma_bound(int n) {
  constexpr T half_ulp = std::numeric_limits<T>::epsilon() / 2;
  return static_cast<T>(n) * half_ulp / (T(1) - static_cast<T>(n) * half_ulp);
}

/// A point interpolated on a triangle, with a bound of its rounding error per coordinate.
template <class T>
struct TrianglePoint {
  Vec3<T> p, error;
};

template <class T>
TrianglePoint<T> point_on_triangle(const Vec3<T>& v0, const Vec3<T>& v1, const Vec3<T>& v2, T b1, T b2) {
  const T b0 = T(1) - b1 - b2;
  const Vec3<T> a = v0 * b0, b = v1 * b1, c = v2 * b2;
  const auto magnitude = [](const Vec3<T>& v) {
    return Vec3<T>(std::abs(v.x), std::abs(v.y), std::abs(v.z));
  };
  return {a + b + c, (magnitude(a) + magnitude(b) + magnitude(c)) * gamma_bound<T>(7)};
}

/// The origin of a ray that leaves a surface on the side of `direction`: `p` pushed along the unit normal by
/// the projection of its error bound, each coordinate rounded one step outward. Never on the other side of
/// the surface, and no further from it than rounding demands (Pharr et al., Physically Based Rendering,
/// "Robust spawned ray origins").
template <class T>
Vec3<T> offset_origin(const Vec3<T>& p, const Vec3<T>& error, const Vec3<T>& normal,
                      const Vec3<T>& direction) {
  const T distance =
      std::abs(normal.x) * error.x + std::abs(normal.y) * error.y + std::abs(normal.z) * error.z;
  const Vec3<T> push = normal * (dot(direction, normal) < 0 ? -distance : distance);
  const auto outward = [](T q, T step) {
    constexpr T infinity = std::numeric_limits<T>::infinity();
    return step > 0 ? std::nextafter(q, infinity) : step < 0 ? std::nextafter(q, -infinity) : q;
  };
  return {outward(p.x + push.x, push.x), outward(p.y + push.y, push.y), outward(p.z + push.z, push.z)};
}

}  // namespace castray
