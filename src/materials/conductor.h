#pragma once

#include <algorithm>
#include <cmath>

#include "materials/bsdf_sample.h"
#include "materials/descriptor.h"
#include "materials/ggx.h"
#include "materials/lobe_albedo.h"
#include "materials/surface_values.h"

namespace castray {

const MaterialDescriptor& conductor_descriptor();

/// Unpolarised Fresnel reflectance of a metal of complex index eta + i k, seen from air, at `cosine` in [0,1]
/// (Born and Wolf, Principles of Optics, section 14.2).
template <class T>
T fresnel_conductor(T cosine, T eta, T k) {
  const T cos2 = cosine * cosine, sin2 = std::max(T(1) - cos2, T(0));
  const T difference = eta * eta - k * k - sin2;
  const T sum =
      std::sqrt(difference * difference + 4 * eta * eta * k * k);  // a^2 + b^2, of b no more is needed
  const T a = std::sqrt(std::max((sum + difference) / 2, T(0)));
  const T along = sum + cos2, across = 2 * a * cosine;
  const T p = cos2 * sum + sin2 * sin2, q = across * sin2;
  return (along - across) * p / ((along + across) * (p + q));
}

/// The mean of a conductor's Fresnel term over directions to its facets, 2 * integral of F(c) c dc, where it
/// follows from an index.
Vec3d mean_fresnel(const Material& m);

/// A metal: f = F D G2 / (4 cos_i cos_o), or a mirror where smooth, and what facets reflect more than once
/// where that is asked for. F is constant, or follows from a complex index.
template <class T>
struct Conductor {
  Vec3<T> reflectance;
  Vec3<T> eta, k;  ///< eta 0: F is `reflectance`
  Ggx<T> ggx;
  Vec3<T> scattered{};                 ///< scattered_again, or 0
  const LobeAlbedo* albedo = nullptr;  ///< of ggx.alpha where `scattered` is not 0; not owned

  static const MaterialDescriptor& descriptor() { return conductor_descriptor(); }
  static Conductor make(const SurfaceValues<double>& values, const Material& m, const LobeTables& lobes) {
    const Vec3d reflectance = values.color(slot_ks);
    Conductor metal{Vec3<T>(reflectance),
                    Vec3<T>(m.eta),
                    Vec3<T>(m.k),
                    {static_cast<T>(values.at(slot_alpha)), m.correlated_masking,
                     static_cast<T>(lobe_aspect(m, values))}};
    if (!lobes.own) return metal;
    metal.scattered = Vec3<T>(scattered_again(m.has_index() ? mean_fresnel(m) : reflectance, *lobes.own));
    metal.albedo = lobes.own;
    return metal;
  }

  Vec3<T> evaluate(const Vec3<T>& wo_, const Vec3<T>& wi_) const {
    const Vec3<T> wo = flip_with(wo_, wo_), wi = flip_with(wo_, wi_);
    if (ggx.smooth() || !(wo.z > 0) || !(wi.z > 0)) return {};
    const Vec3<T> h = normalize(wo + wi);
    const Vec3<T> once = fresnel(dot(wo, h)) * (ggx.distribution(h) * ggx.shadowing_over_cos(wo, wi));
    return albedo ? once + scattered * (lost(wo) * lost(wi) / pi<T>) : once;
  }

  T pdf(const Vec3<T>& wo_, const Vec3<T>& wi_) const {
    const Vec3<T> wo = flip_with(wo_, wo_), wi = flip_with(wo_, wi_);
    if (ggx.smooth() || !(wo.z > 0) || !(wi.z > 0)) return 0;
    const T once = ggx.reflection_pdf(wo, normalize(wo + wi), ggx.cap_scale(wo));
    if (!albedo) return once;
    const T p = lobe_probability(wo);
    return p * once + (T(1) - p) * wi.z / pi<T>;
  }

  BsdfSample<T> sample(const Vec3<T>& wo_, T u_lobe, Point2<T> u) const {
    const Vec3<T> wo = flip_with(wo_, wo_);
    if (!(wo.z > 0)) return {};
    if (ggx.smooth())
      return {.weight = fresnel(wo.z), .wi = {-wo_.x, -wo_.y, wo_.z}, .pdf = 1, .specular = true};
    const T cap = ggx.cap_scale(wo);
    if (albedo) return sample_both(wo_, u_lobe < lobe_probability(wo), u, cap);
    const Vec3<T> h = ggx.sample_normal(wo, u, cap);
    const Vec3<T> wi = normalize(reflect(wo, h));
    if (!(wi.z > 0)) return {};
    return {.weight = fresnel(dot(wo, h)) * ggx.reflection_weight(wo, wi, cap),
            .wi = flip_with(wo_, wi),
            .pdf = ggx.reflection_pdf(wo, normalize(wo + wi), cap)};
  }

 private:
  Vec3<T> fresnel(T cosine) const {
    if (!(eta.x > 0)) return reflectance;
    return {fresnel_conductor(cosine, eta.x, k.x), fresnel_conductor(cosine, eta.y, k.y),
            fresnel_conductor(cosine, eta.z, k.z)};
  }

  /// 1 - E of facets that reflect all.
  T lost(const Vec3<T>& w) const { return albedo->left(w.z, Vec3<T>(1)).x; }

  /// How often light reflected once is sampled: by the luminances of the albedos.
  T lobe_probability(const Vec3<T>& wo) const {
    const T once = luminance(reflectance) * (T(1) - lost(wo));
    const T again = luminance(scattered) * lost(wo) * T(albedo->mean().lost);
    return once > 0 ? once / (once + again) : T(1);
  }

  BsdfSample<T> sample_both(const Vec3<T>& wo_, bool once, Point2<T> u, T cap) const {
    const Vec3<T> wo = flip_with(wo_, wo_);
    const Vec3<T> wi = once ? normalize(reflect(wo, ggx.sample_normal(wo, u, cap))) : cosine_hemisphere(u);
    const T density = pdf(wo, wi);
    if (!(density > 0)) return {};
    return {.weight = evaluate(wo, wi) * (wi.z / density), .wi = flip_with(wo_, wi), .pdf = density};
  }
};

}  // namespace castray
