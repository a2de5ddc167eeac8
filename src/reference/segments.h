#pragma once

#include <optional>

#include "geometry/ray.h"
#include "lights/area_lights.h"
#include "reference/surface.h"

namespace castray {

/// The error bound of a surface point as the far end of `segment`: its triangle is tested from the other end.
template <class T>
Vec3<T> far_error(const Surface<T>& x, const Vec3<T>& segment) {
  return x.error + error_of_test(x.test_growth * max_component(magnitude(segment)));
}

/// Ray-origin offsets and visibility: by the hits' error bounds or, for comparison, by the classic absolute
/// epsilon (then the scene must be in the file's own coordinates).
template <class T>
struct Segments {
  std::optional<double> epsilon;

  /// With an absolute epsilon the hit point is taken along the ray, without an error bound.
  void place(Surface<T>& x, const Hit<T>& hit, const Ray<T>& ray) const {
    if (!epsilon) return;
    x.p = ray.origin + ray.direction * hit.t;
    x.error = {};
  }

  Vec3<T> origin(const Surface<T>& x, const Vec3<T>& direction) const {
    if (!epsilon) return offset_origin(x.p, x.error, x.normal, direction);
    const T side = dot(direction, x.normal) < 0 ? T(-1) : T(1);
    return x.p + x.normal * (side * static_cast<T>(*epsilon));
  }

  /// Whether nothing lies between x and y: no hit with t < 1 on the unnormalised segment between both offset
  /// points. It is traced from the light, because the error at the far end grows with the distance: an
  /// occluder so near to x that it is missed there would have stopped the path before x. With an absolute
  /// epsilon: the first hit from x towards y is within epsilon of y. `there`: which hits count.
  template <class Accel>
  bool visible(const Accel& accel, const Surface<T>& x, const LightPoint<T>& y,
               const HitFilter<T>& there) const {
    const Vec3<T> towards = y.p - x.p;
    if (epsilon) {
      const Vec3<T> from = origin(x, towards);
      const Ray<T> ray{from, normalize(y.p - from)};
      const HitFilter<T> counts = [&](const Hit<T>& h) {
        return !there || h.triangle == y.triangle || there(h);
      };
      const Hit<T> hit = accel.closest(ray, counts);
      return hit.found() && length(y.p - (from + ray.direction * hit.t)) < static_cast<T>(*epsilon);
    }
    const Vec3<T> from = offset_origin(y.p, y.error, y.normal, -towards);
    const Vec3<T> to = offset_origin(x.p, far_error(x, towards), x.normal, towards);
    return !accel.occluded(Ray<T>{from, to - from, T(1)}, there);
  }
};

/// Whether x lies in y's plane or y in x's, within rounding errors: then neither lights the other, and
/// cos cos' / |x' - x|^2 would be a quotient of rounding errors.
template <class T>
bool in_one_plane(const Surface<T>& x, const LightPoint<T>& y, const Vec3<T>& segment) {
  const Vec3<T> error = far_error(x, segment) + y.error;
  const auto within_error = [&](const Vec3<T>& n) {
    return std::abs(dot(n, segment)) <= dot(magnitude(n), error);
  };
  return within_error(x.normal) || within_error(y.normal);
}

}  // namespace castray
