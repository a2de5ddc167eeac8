#include "scene/transform.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace castray {

namespace {

void turn_round(std::vector<Index3>& triangles) {
  for (Index3& corners : triangles) std::swap(corners[1], corners[2]);
}

}  // namespace

bool Transform::is_invertible() const {
  constexpr double rounding = 1e-13;
  const double volume = std::abs(determinant()), most = length(rows[0]) * length(rows[1]) * length(rows[2]);
  return volume > rounding * most && std::isfinite(most) && is_finite(translation);
}

double Transform::skew() const {
  const double volume = std::abs(determinant());
  const Vec3d cofactors[3] = {cross(rows[1], rows[2]), cross(rows[2], rows[0]), cross(rows[0], rows[1])};
  double most = 1;
  for (const Vec3d& row : rows) {  // of |this| |inverse|, whose columns the cofactors are
    double sum = 0;
    for (int i = 0; i < 3; ++i)
      for (const Vec3d& cofactor : cofactors) sum += std::abs(row[i] * cofactor[i]);
    most = std::max(most, sum / volume);
  }
  return most;
}

Transform Transform::then(const Transform& next) const {
  Transform result;
  for (int i = 0; i < 3; ++i)
    result.rows[i] = rows[0] * next.rows[i].x + rows[1] * next.rows[i].y + rows[2] * next.rows[i].z;
  result.translation = next.point(translation);
  return result;
}

Transform Transform::scale(const Vec3d& factors) {
  return {{{factors.x, 0, 0}, {0, factors.y, 0}, {0, 0, factors.z}}, {}};
}

Transform Transform::rotate(const Vec3d& axis, double degrees) {
  // Rodrigues' formula; quarter turns are exact.
  const Vec3d a =
      normalize(axis / max_component(Vec3d{std::abs(axis.x), std::abs(axis.y), std::abs(axis.z)}));
  const double turn = std::remainder(degrees, 360.0);
  const double radians = turn * std::numbers::pi / 180;
  const double s = std::fmod(turn, 180.0) == 0 ? 0 : std::sin(radians);
  const double c = std::fmod(std::abs(turn), 180.0) == 90 ? 0 : std::cos(radians);
  const double d = 1 - c;
  return {{{c + a.x * a.x * d, a.x * a.y * d - a.z * s, a.x * a.z * d + a.y * s},
           {a.y * a.x * d + a.z * s, c + a.y * a.y * d, a.y * a.z * d - a.x * s},
           {a.z * a.x * d - a.y * s, a.z * a.y * d + a.x * s, c + a.z * a.z * d}},
          {}};
}

Transform Transform::translate(const Vec3d& offset) {
  Transform result;
  result.translation = offset;
  return result;
}

void apply(const Transform& transform, Mesh& mesh) {
  for (Vec3d& p : mesh.positions) p = transform.point(p);
  // The cofactors: the inverse transpose times the determinant, whose sign is taken out again.
  const double sign = transform.determinant() < 0 ? -1 : 1;
  const Vec3d* m = transform.rows;
  const Transform cofactors{{cross(m[1], m[2]) * sign, cross(m[2], m[0]) * sign, cross(m[0], m[1]) * sign},
                            {}};
  for (Vec3f& n : mesh.normals) n = Vec3f(normalize(cofactors.linear(Vec3d(n))));
  if (sign > 0) return;
  turn_round(mesh.triangles);
  turn_round(mesh.triangle_normals);
  turn_round(mesh.triangle_uvs);
  turn_round(mesh.triangle_colors);
}

}  // namespace castray
