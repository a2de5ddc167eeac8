#pragma once

#include <cmath>

#include "materials/bsdf_sample.h"
#include "materials/descriptor.h"
#include "materials/ggx.h"
#include "materials/surface_values.h"

namespace castray {

/// Unpolarised Fresnel reflectance at cosine `cos_i` >= 0, `eta` = n_t / n_i; 1 at total reflection.
template <class T>
T fresnel_dielectric(T cos_i, T eta) {
  const T sin2_t = (T(1) - cos_i * cos_i) / (eta * eta);
  if (sin2_t >= 1) return 1;
  const T cos_t = std::sqrt(T(1) - sin2_t);
  const T parallel = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
  const T perpendicular = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
  return (parallel * parallel + perpendicular * perpendicular) / 2;
}

/// w refracted at a surface of normal h, dot(w,h) > 0, eta = n_t / n_i; not to be called at total reflection.
template <class T>
Vec3<T> refract(const Vec3<T>& w, const Vec3<T>& h, T eta) {
  const T cos_i = dot(w, h);
  const T cos_t = std::sqrt(std::max(T(0), T(1) - (T(1) - cos_i * cos_i) / (eta * eta)));
  return h * (cos_i / eta - cos_t) - w / eta;
}

/// What a pane reflects of the light that arrives at cosine `cos_i` >= 0: between its two surfaces, each of
/// which reflects f, light goes to and fro, so it is f + (1 - f)^2 f / (1 - f^2).
template <class T>
T pane_reflectance(T cos_i, T ior) {
  const T f = fresnel_dielectric(cos_i, ior);
  return 2 * f / (1 + f);
}

const MaterialDescriptor& dielectric_descriptor();

/// Glass: reflection and refraction by the exact Fresnel equations, smooth or through GGX facets (Walter et
/// al. 2007). What passes is tinted at each crossing. The normal points out of the medium of index `ior`.
/// Radiance scales by (n_o / n_i)^2 where it crosses the surface.
///
/// A thin wall is a pane of two smooth surfaces: what it does not reflect goes straight on, tinted once. It
/// is a window where rays pass as if nothing were there with the probability of what the colour keeps that
/// passes best, and dim the others (Coverage): such a ray needs no vertex, and shadow rays find what is
/// behind. Its BSDF is then that of the mirror alone.
template <class T>
struct Dielectric {
  T ior;
  Ggx<T> ggx;
  Vec3<T> transmittance{1};
  bool thin = false, window = false;

  static const MaterialDescriptor& descriptor() { return dielectric_descriptor(); }
  static Dielectric make(const SurfaceValues<double>& values, const Material& m, const LobeTables&) {
    return {static_cast<T>(m.ior),
            {static_cast<T>(values.at(slot_alpha)), m.correlated_masking},
            Vec3<T>(values.color(slot_kd)),
            m.thin,
            m.is_window()};
  }

  Vec3<T> evaluate(const Vec3<T>& wo_, const Vec3<T>& wi_) const {
    const Crossing c(*this, wo_, wi_);
    if (!c.possible) return {};
    const T f = fresnel_dielectric(dot(c.wo, c.h), c.eta);
    const T d = ggx.distribution(c.h);
    if (c.reflection) return Vec3<T>(f * d * ggx.shadowing_over_cos(c.wo, c.wi));
    const Vec3<T> below = -c.wi;  // masking depends on the cosine's magnitude only
    const T facet = dot(c.wi, c.h) * dot(c.wo, c.h) / (c.denominator * c.denominator);
    return transmittance *
           ((T(1) - f) * d * 4 * ggx.shadowing_over_cos(c.wo, below) * std::abs(facet) / (c.eta * c.eta));
  }

  T pdf(const Vec3<T>& wo_, const Vec3<T>& wi_) const {
    const Crossing c(*this, wo_, wi_);
    if (!c.possible) return 0;
    const T f = fresnel_dielectric(dot(c.wo, c.h), c.eta);
    if (c.reflection) return f * ggx.reflection_pdf(c.wo, c.h, 1);
    const T visible = 2 * ggx.masking_over_cos(c.wo) * dot(c.wo, c.h) * ggx.distribution(c.h);
    return (T(1) - f) * visible * std::abs(dot(c.wi, c.h)) / (c.denominator * c.denominator);
  }

  BsdfSample<T> sample(const Vec3<T>& wo_, T u_lobe, Point2<T> u) const {
    const Vec3<T> wo = flip_with(wo_, wo_);
    if (!(wo.z > 0)) return {};
    if (thin) return sample_thin(wo_, u_lobe);
    const T eta = relative_ior(wo_);
    const Vec3<T> h = smooth() ? Vec3<T>(0, 0, 1) : ggx.sample_normal(wo, u, 1);
    const T f = fresnel_dielectric(dot(wo, h), eta);
    const bool reflected = u_lobe < f;
    const Vec3<T> wi = normalize(reflected ? reflect(wo, h) : refract(wo, h, eta));
    const T eta2 = reflected ? T(1) : eta * eta;
    if (reflected != (wi.z > 0) || wi.z == 0) return {};
    const Vec3<T> tint = reflected ? Vec3<T>(1) : transmittance;
    if (smooth())
      return {.weight = tint * (T(1) / eta2),
              .wi = flip_with(wo_, wi),
              .pdf = reflected ? f : T(1) - f,
              .specular = true,
              .eta2 = eta2};
    // G2 / G1(wo), without a vanishing denominator
    const Vec3<T> up = reflected ? wi : -wi;
    const T weight = ggx.reflection_weight(wo, up, 1) / eta2;
    const Vec3<T> wi_out = flip_with(wo_, wi);
    return {.weight = tint * weight, .wi = wi_out, .pdf = pdf(wo_, wi_out), .eta2 = eta2};
  }

 private:
  bool smooth() const { return ggx.smooth() || ior == 1 || thin; }

  BsdfSample<T> sample_thin(const Vec3<T>& wo, T u_lobe) const {
    const T reflectance = pane_reflectance(std::abs(wo.z), ior);
    const Vec3<T> mirrored(-wo.x, -wo.y, wo.z);
    if (window) {  // what passes does not come here
      const T there = reflectance + (1 - reflectance) * (1 - max_component(transmittance));
      if (!(reflectance > 0)) return {};
      return {.weight = Vec3<T>(reflectance / there), .wi = mirrored, .pdf = 1, .specular = true};
    }
    const bool reflected = u_lobe < reflectance;
    return {.weight = reflected ? Vec3<T>(1) : transmittance,
            .wi = reflected ? mirrored : -wo,
            .pdf = reflected ? reflectance : 1 - reflectance,
            .specular = true};
  }

  /// n_i / n_o: of the medium beyond the surface over that of wo's side.
  T relative_ior(const Vec3<T>& wo) const { return wo.z < 0 ? T(1) / ior : ior; }

  /// A pair of directions turned so that wo.z > 0, and the facet normal that maps one to the other.
  struct Crossing {
    Vec3<T> wo, wi, h;
    T eta = 1, denominator = 1;
    bool reflection = false, possible = false;

    Crossing(const Dielectric& glass, const Vec3<T>& wo_, const Vec3<T>& wi_)
        : wo(flip_with(wo_, wo_)), wi(flip_with(wo_, wi_)), eta(glass.relative_ior(wo_)) {
      if (glass.smooth() || !(wo.z > 0) || wi.z == 0) return;
      reflection = wi.z > 0;
      const Vec3<T> sum = reflection ? wo + wi : wo + wi * eta;
      h = normalize(sum.z < 0 ? -sum : sum);
      possible = h.z > 0 && dot(wo, h) > 0 && dot(wi, h) * wi.z > 0;
      denominator = dot(wi, h) + dot(wo, h) / eta;
    }
  };
};

}  // namespace castray
