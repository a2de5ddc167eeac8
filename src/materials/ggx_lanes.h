#pragma once

#include "simd/vec_lanes.h"

// materials/ggx.h in lanes. Directions are in a frame whose +z is the normal, on the viewer's side.

namespace castray::CASTRAY_ISA {

CASTRAY_INLINE Vec reflect(Vec w, Vec h) { return fma(h, Float(2.f) * dot(w, h), -w); }

CASTRAY_INLINE Float ggx_stretched_length(Float alpha, Vec w) {
  return sqrt(fma(alpha * alpha, fma(w.x, w.x, w.y * w.y), w.z * w.z));
}
CASTRAY_INLINE Float ggx_distribution(Float alpha, Vec h) {
  const Float a2 = alpha * alpha;
  const Float s = fma(h.x, h.x, h.y * h.y) / a2 + h.z * h.z;
  return Float(1.f / pi) / (a2 * s * s);
}
/// G2 / (4 wo.z wi.z). `alpha`: Float, or GgxWidths.
template <class Alpha>
CASTRAY_INLINE Float ggx_shadowing_over_cos(const Alpha& alpha, Vec wo, Vec wi) {
  return Float(0.5f) / fma(wi.z, ggx_stretched_length(alpha, wo), wo.z * ggx_stretched_length(alpha, wi));
}
/// Part of the spherical cap that reflection above the horizon can need (Eto and Tokuyoshi 2023).
CASTRAY_INLINE Float ggx_cap_scale(Float alpha, Vec wo) {
  const Float a2 = min(alpha * alpha, Float(1.f));
  const Float s2 = square(Float(1.f) + sqrt(fma(wo.x, wo.x, wo.y * wo.y)));
  return (Float(1.f) - a2) * s2 / fma(a2, wo.z * wo.z, s2);
}
/// A normal, not of unit length, visible from the unit vector w where alpha is 1.
CASTRAY_INLINE Vec ggx_sample_cap(Vec w, Float u, Float v, Float cap) {
  const Float z = Float(1.f) - u * fma(cap, w.z, Float(1.f));
  const Float r = sqrt(max((Float(1.f) - z) * (Float(1.f) + z), Float(0.f)));
  const SinCos turn = sincos_turn(v);
  return {fma(r, turn.cos, w.x), fma(r, turn.sin, w.y), z + w.z};
}
/// A normal visible from wo (Dupuy and Benyoub 2023).
CASTRAY_INLINE Vec ggx_sample_normal(Float alpha, Vec wo, Float u, Float v, Float cap) {
  const Vec w = Vec{alpha * wo.x, alpha * wo.y, wo.z} * (Float(1.f) / ggx_stretched_length(alpha, wo));
  const Vec h = ggx_sample_cap(w, u, v, cap);
  return normalize(Vec{alpha * h.x, alpha * h.y, max(h.z, Float(0.f))});
}
CASTRAY_INLINE Float ggx_reflection_pdf(Float alpha, Vec wo, Vec h, Float cap) {
  return ggx_distribution(alpha, h) / (Float(2.f) * fma(cap, wo.z, ggx_stretched_length(alpha, wo)));
}

/// The widths of a lobe that is not round: slopes are those of a round one of width 1, multiplied by the
/// matrix (mean + x, y; y, mean - x), whose determinant is alpha^2.
struct GgxWidths {
  Float alpha, mean, x, y, least;

  CASTRAY_INLINE Vec widen(const Vec& w) const {
    return {fma(mean + x, w.x, y * w.y), fma(y, w.x, (mean - x) * w.y), w.z};
  }
  /// The inverse.
  CASTRAY_INLINE Vec narrow(const Vec& w) const {
    const Float scale = Float(1.f) / (alpha * alpha);
    return {fma(mean - x, w.x, -(y * w.y)) * scale, fma(mean + x, w.y, -(y * w.x)) * scale, w.z};
  }
};
/// `x`, `y`: slot_stretch.
CASTRAY_INLINE GgxWidths ggx_widths(Float alpha, Float x, Float y) {
  const Float strength2 = fma(x, x, y * y), mean = sqrt(Float(1.f) + strength2);
  return {alpha, alpha * mean, alpha * x, alpha * y, alpha / (mean + sqrt(strength2))};
}
CASTRAY_INLINE Float ggx_stretched_length(const GgxWidths& a, Vec w) {
  return sqrt(length_squared(a.widen(w)));
}
CASTRAY_INLINE Float ggx_distribution(const GgxWidths& a, Vec h) {
  return Float(1.f / pi) / square(a.alpha * length_squared(a.narrow(h)));
}
CASTRAY_INLINE Float ggx_reflection_pdf(const GgxWidths& a, Vec wo, Vec h, Float cap) {
  return ggx_distribution(a, h) / (Float(2.f) * fma(cap, wo.z, ggx_stretched_length(a, wo)));
}
CASTRAY_INLINE Float ggx_cap_scale(const GgxWidths& a, Vec wo) { return ggx_cap_scale(a.least, wo); }
CASTRAY_INLINE Vec ggx_sample_normal(const GgxWidths& a, Vec wo, Float u, Float v, Float cap) {
  const Vec h = ggx_sample_cap(a.widen(wo) * (Float(1.f) / ggx_stretched_length(a, wo)), u, v, cap);
  return normalize(a.widen({h.x, h.y, max(h.z, Float(0.f))}));
}

/// Unpolarised Fresnel reflectance at cos_i >= 0, eta = n_t / n_i; 1 at total reflection.
CASTRAY_INLINE Float fresnel_dielectric(Float cos_i, Float eta) {
  const Float sin2_t = (Float(1.f) - cos_i * cos_i) / (eta * eta);
  const Float cos_t = sqrt(max(Float(1.f) - sin2_t, Float(0.f)));
  const Float parallel = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
  const Float perpendicular = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
  return select(sin2_t >= Float(1.f), Float(1.f),
                Float(0.5f) * fma(parallel, parallel, perpendicular * perpendicular));
}
/// w refracted at the normal h, dot(w,h) > 0, eta = n_t / n_i.
CASTRAY_INLINE Vec refract(Vec w, Vec h, Float eta) {
  const Float cos_i = dot(w, h);
  const Float cos_t = sqrt(max(Float(1.f) - (Float(1.f) - cos_i * cos_i) / (eta * eta), Float(0.f)));
  return h * (cos_i / eta - cos_t) - w * (Float(1.f) / eta);
}

}  // namespace castray::CASTRAY_ISA
