#pragma once

#include <algorithm>
#include <cmath>

#include "core/warp.h"

namespace castray {

/// The GGX distribution of microfacet normals (Walter et al. 2007) with height-correlated Smith masking
/// (Heitz 2014), in a frame whose +z is the surface normal. All directions have z > 0 unless said otherwise.
/// Its widths are a_x = alpha / aspect along x and a_y = alpha aspect along y.
///
/// With l(w) = |(a_x w.x, a_y w.y, w.z)|, Smith's G1(w) is 2 w.z / (w.z + l(w)); written so, no quotient
/// below has a vanishing denominator at grazing angles.
template <class T>
struct Ggx {
  T alpha;
  bool correlated = true;  ///< masking and shadowing; false as some renderers have it, G1(wo) G1(wi)
  T aspect = 1;

  /// Below this width a lobe is treated as a perfect mirror.
  static constexpr T smooth_below = T(1e-4);
  bool smooth() const { return alpha < smooth_below; }

  T stretched_length(const Vec3<T>& w) const {
    const T ratio = aspect * aspect;
    return std::sqrt(alpha * alpha * (w.x * w.x / ratio + w.y * w.y * ratio) + w.z * w.z);
  }

  /// D(h), per solid angle of h. Uses h.x, h.y rather than 1 - h.z^2, which cancels for narrow lobes.
  T distribution(const Vec3<T>& h) const {
    const T ratio = aspect * aspect;
    const T slope2 = (h.x * h.x * ratio + h.y * h.y / ratio) / (alpha * alpha);
    const T s = slope2 + h.z * h.z;
    return T(1) / (pi<T> * alpha * alpha * s * s);
  }

  /// G1(w) / (2 w.z).
  T masking_over_cos(const Vec3<T>& w) const { return T(1) / (w.z + stretched_length(w)); }

  /// G2(wo, wi) / (4 wo.z wi.z).
  T shadowing_over_cos(const Vec3<T>& wo, const Vec3<T>& wi) const {
    if (!correlated) return masking_over_cos(wo) * masking_over_cos(wi);
    return T(0.5) / (wi.z * stretched_length(wo) + wo.z * stretched_length(wi));
  }

  /// Part of the spherical cap that reflection above the horizon can need (Eto and Tokuyoshi 2023, eq. 4);
  /// 1 is the whole cap.
  T cap_scale(const Vec3<T>& wo) const {
    const T narrow = alpha * aspect, a2 = std::min(narrow * narrow, T(1));
    const T s = T(1) + std::sqrt(wo.x * wo.x + wo.y * wo.y);
    return (T(1) - a2) * s * s / (s * s + a2 * wo.z * wo.z);
  }

  /// A normal visible from wo, by reflecting wo's direction in the unit-roughness sphere: a spherical cap
  /// (Dupuy and Benyoub 2023), shortened by `cap` (1 or cap_scale).
  Vec3<T> sample_normal(const Vec3<T>& wo, Point2<T> u, T cap) const {
    const T along = alpha / aspect, across = alpha * aspect;
    const Vec3<T> w = Vec3<T>(along * wo.x, across * wo.y, wo.z) / stretched_length(wo);
    const T z = T(1) - u.x * (T(1) + cap * w.z);
    const Vec3<T> on_cap = spherical(z, (T(1) - z) * (T(1) + z), 2 * pi<T> * u.y);
    const Vec3<T> h = on_cap + w;
    return normalize(Vec3<T>(along * h.x, across * h.y, std::max(h.z, T(0))));
  }

  /// Density, per solid angle of wi, of reflecting wo in sample_normal's h.
  T reflection_pdf(const Vec3<T>& wo, const Vec3<T>& h, T cap) const {
    return distribution(h) / (2 * (cap * wo.z + stretched_length(wo)));
  }

  /// G2 D / (4 wo.z wi.z) * wi.z / reflection_pdf: the weight of a reflected sample, without Fresnel.
  T reflection_weight(const Vec3<T>& wo, const Vec3<T>& wi, T cap) const {
    return shadowing_over_cos(wo, wi) * wi.z * 2 * (cap * wo.z + stretched_length(wo));
  }
};

/// (1 - cosine)^5, by which Schlick's Fresnel term goes from F0 to 1.
template <class T>
T schlick_weight(T cosine) {
  const T m = std::clamp(T(1) - cosine, T(0), T(1));
  return m * m * m * m * m;
}
template <class T>
Vec3<T> schlick(const Vec3<T>& f0, T weight) {
  return f0 * (T(1) - weight) + Vec3<T>(weight);
}

/// The mean of that term over directions to a surface, 2 * integral of F(c) c dc.
inline Vec3d mean_schlick(const Vec3d& f0) { return f0 + (Vec3d(1) - f0) / 21; }

/// w mirrored in the unit vector h.
template <class T>
Vec3<T> reflect(const Vec3<T>& w, const Vec3<T>& h) {
  return h * (2 * dot(w, h)) - w;
}

}  // namespace castray
