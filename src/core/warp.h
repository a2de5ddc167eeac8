#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "castray/vec.h"

namespace castray {

/// Two random numbers in [0,1).
template <class T>
struct Point2 {
  T x, y;
};

template <class T>
constexpr T pi = std::numbers::pi_v<T>;

/// The direction of polar angle acos(z) and azimuth `phi`, about +z. 1 - z*z is passed in, so that it can be
/// given without cancellation.
template <class T>
Vec3<T> spherical(T z, T one_minus_z2, T phi) {
  const T s = std::sqrt(std::max(one_minus_z2, T(0)));
  return {s * std::cos(phi), s * std::sin(phi), z};
}

/// Upper hemisphere, density z / pi. z is never 0, as u.x < 1.
template <class T>
Vec3<T> cosine_hemisphere(Point2<T> u) {
  return spherical(std::sqrt(T(1) - u.x), u.x, 2 * pi<T> * u.y);
}

/// Barycentric weights (b1, b2) of a point uniform on a triangle.
template <class T>
std::array<T, 2> uniform_triangle(Point2<T> u) {
  const T root = std::sqrt(u.x);
  return {root * (T(1) - u.y), root * u.y};
}

}  // namespace castray
