#pragma once

#include <cmath>

#include "castray/vec.h"

namespace castray {

/// An orthonormal basis around a unit normal; directions in it have the normal as +z.
template <class T>
struct Frame {
  Vec3<T> tangent, bitangent, normal;

  Vec3<T> to_local(const Vec3<T>& v) const { return {dot(v, tangent), dot(v, bitangent), dot(v, normal)}; }
  Vec3<T> to_world(const Vec3<T>& v) const { return tangent * v.x + bitangent * v.y + normal * v.z; }
};

/// The basis of Duff et al. 2017, "Building an Orthonormal Basis, Revisited": no singular direction.
template <class T>
Frame<T> make_frame(const Vec3<T>& n) {
  const T sign = std::copysign(T(1), n.z);
  const T a = T(-1) / (sign + n.z);
  const T b = n.x * n.y * a;
  return {{T(1) + sign * n.x * n.x * a, sign * b, -sign * n.x}, {b, sign + n.y * n.y * a, -n.y}, n};
}

}  // namespace castray
