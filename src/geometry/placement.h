#pragma once

#include "core/error_bounds.h"
#include "geometry/ray.h"

namespace castray {

// How what a scene holds of a triangle is turned to scene space.

/// It is there already.
struct InPlace {
  template <class T>
  TrianglePoint<T> point(const TrianglePoint<T>& p) const {
    return p;
  }
  template <class T>
  Vec3<T> normal(const Vec3<T>& n) const {
    return n;
  }
  template <class T>
  Vec3<T> direction(const Vec3<T>& v) const {
    return v;
  }
  int handedness() const { return 1; }
  double growth() const { return 1; }
};

/// It is in the space of an instance's mesh.
class Placed {
 public:
  explicit Placed(const SceneInstance& at);

  /// A point with what rounding does to it on the way, to the rays that leave it for the object's space
  /// included.
  template <class T>
  TrianglePoint<T> point(const TrianglePoint<T>& point) const;

  /// Unit, on the side that is outward.
  template <class T>
  Vec3<T> normal(const Vec3<T>& n) const {
    return Vec3<T>(
        normalize(to_object_[0] * double{n.x} + to_object_[1] * double{n.y} + to_object_[2] * double{n.z}));
  }
  template <class T>
  Vec3<T> direction(const Vec3<T>& v) const {
    return Vec3<T>(product(to_scene_, Vec3d(v)));
  }
  /// -1 where left and right change places.
  int handedness() const { return mirrors_ ? -1 : 1; }

  Vec3d to_object(const Vec3d& p) const { return direction_to_object(p - translation_); }
  Vec3d direction_to_object(const Vec3d& v) const { return product(to_object_, v); }
  /// Of the matrix of direction_to_object.
  const Vec3d& to_object_row(int i) const { return to_object_[i]; }

  /// The factor of error_of_test for triangles that are tested in the object's space: the greatest sum of a
  /// row of |to scene| |to object|, and half as much again, for rounding the ray on its way.
  double growth() const { return growth_; }

 private:
  static Vec3d product(const Vec3d (&rows)[3], const Vec3d& v) {
    return {dot(rows[0], v), dot(rows[1], v), dot(rows[2], v)};
  }
  /// |rows| v, of a v without negative components.
  static Vec3d spread(const Vec3d (&rows)[3], const Vec3d& v) {
    return {dot(magnitude(rows[0]), v), dot(magnitude(rows[1]), v), dot(magnitude(rows[2]), v)};
  }

  bool mirrors_;
  double growth_;
  Vec3d to_scene_[3], to_object_[3], translation_;
};

template <class T>
TrianglePoint<T> Placed::point(const TrianglePoint<T>& point) const {
  const Vec3d p = product(to_scene_, Vec3d(point.p)) + translation_;
  const Vec3d size = spread(to_scene_, Vec3d(magnitude(point.p)));
  const Vec3d error = spread(to_scene_, Vec3d(point.error) + spread(to_object_, size) * gamma_bound<T>(8)) +
                      (size + magnitude(translation_)) * gamma_bound<T>(10);
  return {Vec3<T>(p), Vec3<T>(error)};
}

}  // namespace castray
