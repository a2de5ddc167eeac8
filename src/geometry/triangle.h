#pragma once

#include <algorithm>
#include <cmath>

#include "core/error_bounds.h"
#include "geometry/ray.h"
#include "simd/lanes8.h"

namespace castray {

/// Whether a ray can hit anything: finite, and of a size whose reciprocals and products stay in range. All
/// accelerators answer "no hit" for the others. Scene space lies in [-1,1]^3, far from these bounds.
template <class T>
bool is_traceable(const Ray<T>& ray) {
  const Vec3<T> d = magnitude(ray.direction), o = magnitude(ray.origin);
  constexpr T least = T(0x1p-60), most = T(0x1p60), farthest = T(0x1p34);
  // comparisons with NaN are false
  return (d.x >= least || d.y >= least || d.z >= least) && d.x <= most && d.y <= most && d.z <= most &&
         o.x <= farthest && o.y <= farthest && o.z <= farthest;
}

/// a*b - c*d to two ulps, of the exact sign (but for underflow). Jeannerod, Louvet, Muller (2013), after
/// Kahan.
template <class T>
T difference_of_products(T a, T b, T c, T d) {
  const T cd = c * d;
  const T error = std::fma(c, d, -cd);
  return std::fma(a, b, -cd) - error;
}

/// Eight triangles side by side: [vertex][axis][lane].
struct TriangleLanes {
  alignas(32) float vertex[3][3][8];
};

/// The ray/triangle test that every accelerator shares. Watertight: Woop, Benthin, Wald (2013),
/// "Watertight Ray/Triangle Intersection".
///
/// The triangle is moved so that the ray starts at the origin, and sheared so that it runs along its largest
/// axis; each vertex is rounded by itself, so triangles that share a vertex see the same point. The signs of
/// the three edge functions are then decided exactly: a plain difference of products is never of the wrong
/// sign, as rounding is monotone, and the few triangles that pass get the accurate difference. So the
/// triangles of a mesh cover what the sheared, rounded mesh covers, edges and vertices included.
template <class T>
class TriangleTest {
 public:
  explicit TriangleTest(const Ray<T>& ray) : origin_(ray.origin) {
    const Vec3<T>& d = ray.direction;
    const T x = std::abs(d.x), y = std::abs(d.y), z = std::abs(d.z);
    kz_ = x > y ? (x > z ? 0 : 2) : (y > z ? 1 : 2);
    kx_ = kz_ == 2 ? 0 : kz_ + 1;
    ky_ = kx_ == 2 ? 0 : kx_ + 1;
    dz_ = d[kz_];
    sx_ = d[kx_] / dz_;
    sy_ = d[ky_] / dz_;
  }

  /// The axis along which the direction is longest.
  int main_axis() const { return kz_; }

  /// The lanes, as bits, whose triangles the ray may meet with 0 < t < t_max: all but those that `intersect`
  /// rejects at first sight, and those wholly behind the origin or beyond t_max. As its weights never differ
  /// in sign, a computed t is at most a few ulps outside the range of the vertices'.
  unsigned candidates(const TriangleLanes& triangles, T t_max) const {
    const T reach = t_max * std::abs(dz_) * T(1.001), low = dz_ > 0 ? 0 : -reach, high = dz_ > 0 ? reach : 0;
    Lanes8<T> x[3], y[3], z[3];
    for (int k = 0; k < 3; ++k) {
      const auto& v = triangles.vertex[k];
      z[k] = __builtin_convertvector(lanes8(v[kz_]), Lanes8<T>) - origin_[kz_];
      x[k] = __builtin_convertvector(lanes8(v[kx_]), Lanes8<T>) - origin_[kx_] - sx_ * z[k];
      y[k] = __builtin_convertvector(lanes8(v[ky_]), Lanes8<T>) - origin_[ky_] - sy_ * z[k];
    }
    const Lanes8<T> u = x[2] * y[1] - y[2] * x[1], v = x[0] * y[2] - y[0] * x[2],
                    w = x[1] * y[0] - y[1] * x[0];
    const auto mixed = ((u > 0) | (v > 0) | (w > 0)) & ((u < 0) | (v < 0) | (w < 0));
    const auto below = (z[0] < low) & (z[1] < low) & (z[2] < low);
    const auto above = (z[0] > high) & (z[1] > high) & (z[2] > high);
    return ~bits8(mixed | below | above) & 0xffu;
  }

  /// Whether the line of the ray meets the triangle, at which t (of any sign), and where in it.
  bool intersect(const Vec3f& v0, const Vec3f& v1, const Vec3f& v2, T& t, T& b1, T& b2) const {
    const Vec3<T> a = shear(v0), b = shear(v1), c = shear(v2);
    if (mixed_signs(c.x * b.y - c.y * b.x, a.x * c.y - a.y * c.x, b.x * a.y - b.y * a.x)) return false;
    const T u = difference_of_products(c.x, b.y, c.y, b.x);
    const T v = difference_of_products(a.x, c.y, a.y, c.x);
    const T w = difference_of_products(b.x, a.y, b.y, a.x);
    const T det = u + v + w;
    if (mixed_signs(u, v, w) || !(det != 0)) return false;
    t = (u * a.z + v * b.z + w * c.z) / (det * dz_);
    b1 = v / det;
    b2 = w / det;
    return true;
  }

 private:
  static bool mixed_signs(T u, T v, T w) { return (u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0); }

  Vec3<T> shear(const Vec3f& vertex) const {
    const Vec3<T> p = Vec3<T>(vertex) - origin_;
    const T z = p[kz_];
    return {p[kx_] - sx_ * z, p[ky_] - sy_ * z, z};
  }

  Vec3<T> origin_;
  T sx_, sy_, dz_;
  int kx_, ky_, kz_;
};

/// Keeps the nearer of two hits; of equal ones that of the lower triangle, so that the order of visits never
/// matters.
template <class T>
bool is_nearer(T t, std::uint32_t triangle, const Hit<T>& than) {
  return t < than.t || (t == than.t && triangle < than.triangle);
}

/// Tests one triangle of `mesh` and keeps its hit in `hit` if it counts and is nearer.
template <class T>
void intersect_triangle(const TriangleTest<T>& test, const MeshView& mesh, std::uint32_t triangle, T t_max,
                        const HitFilter<T>& counts, Hit<T>& hit) {
  const Index3& v = mesh.triangles[triangle];
  T t, b1, b2;
  if (!test.intersect(mesh.positions[v[0]], mesh.positions[v[1]], mesh.positions[v[2]], t, b1, b2)) return;
  if (!(t > 0 && t < t_max && is_nearer(t, triangle, hit))) return;
  const Hit<T> found{t, triangle, b1, b2};
  if (!counts || counts(found)) hit = found;
}

}  // namespace castray
