#pragma once

#include "castray/vec.h"
#include "scene/mesh.h"

namespace castray {

/// p -> rows . p + translation.
struct Transform {
  Vec3d rows[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  Vec3d translation;

  Vec3d linear(const Vec3d& v) const { return {dot(rows[0], v), dot(rows[1], v), dot(rows[2], v)}; }
  Vec3d point(const Vec3d& p) const { return linear(p) + translation; }
  double determinant() const { return dot(rows[0], cross(rows[1], rows[2])); }
  /// Whether it is finite and maps space onto space, beyond what rounding leaves of a matrix that does not.
  bool is_invertible() const;
  /// How much it skews, at least 1: the most that mapping a box around a point and back widens it. A rotation
  /// widens it up to 3 times, a change of lengths along the axes of the point's own space does not.
  double skew() const;

  /// First this, then `next`.
  Transform then(const Transform& next) const;

  static Transform scale(const Vec3d& factors);
  /// Counter-clockwise seen against the axis, which need not be of unit length but must not be 0.
  static Transform rotate(const Vec3d& axis, double degrees);
  static Transform translate(const Vec3d& offset);
};

/// Of what is kept as an instance, at most.
inline constexpr double most_skew = 16;

/// Moves a mesh. A mirroring transform (negative determinant) also turns each triangle's corners round: the
/// side that was outward, the side that emits, stays outward.
void apply(const Transform& transform, Mesh& mesh);

}  // namespace castray
