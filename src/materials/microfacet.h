#pragma once

#include <algorithm>

#include "materials/bsdf_sample.h"
#include "materials/descriptor.h"
#include "materials/ggx.h"
#include "materials/lobe_albedo.h"
#include "materials/surface_values.h"

namespace castray {

const MaterialDescriptor& microfacet_descriptor();

/// Cook and Torrance's: a GGX lobe with Schlick's Fresnel term, F0 = ks, over a diffuse base that gets what
/// the lobe leaves (the energy-conserving, reciprocal coupling of Kelemen and Szirmay-Kalos 2001):
///
///     f = F D G2 / (4 cos_i cos_o) + kd / pi (1 - E(cos_i)) (1 - E(cos_o)) / (1 - E_mean)
///
/// with E the lobe's directional albedo. A lobe too narrow to evaluate is a mirror over the same base.
template <class T>
struct Microfacet {
  Vec3<T> base;  ///< kd / (1 - E_mean); see base_under
  Vec3<T> f0;
  Ggx<T> ggx;
  const LobeAlbedo* albedo;  ///< of ggx.alpha; not owned

  static const MaterialDescriptor& descriptor() { return microfacet_descriptor(); }
  static Microfacet make(const SurfaceValues<double>& values, const Material& m, const LobeTables& lobes) {
    const Vec3d kd = values.color(slot_kd), ks = values.color(slot_ks);
    return {Vec3<T>(base_under(kd, ks, *lobes.own)),
            Vec3<T>(ks),
            {static_cast<T>(values.at(slot_alpha)), m.correlated_masking},
            lobes.own};
  }

  Vec3<T> evaluate(const Vec3<T>& wo_, const Vec3<T>& wi_) const {
    const Vec3<T> wo = flip_with(wo_, wo_), wi = flip_with(wo_, wi_);
    if (!(wo.z > 0) || !(wi.z > 0)) return {};
    const Vec3<T> diffuse = base * left_for_base(wi) * left_for_base(wo) * (T(1) / pi<T>);
    if (ggx.smooth()) return diffuse;
    const Vec3<T> h = normalize(wo + wi);
    return fresnel(dot(wo, h)) * (ggx.distribution(h) * ggx.shadowing_over_cos(wo, wi)) + diffuse;
  }

  T pdf(const Vec3<T>& wo_, const Vec3<T>& wi_) const {
    const Vec3<T> wo = flip_with(wo_, wo_), wi = flip_with(wo_, wi_);
    if (!(wo.z > 0) || !(wi.z > 0)) return 0;
    const T lobe = lobe_probability(wo);
    const T diffuse = (T(1) - lobe) * wi.z * (T(1) / pi<T>);
    if (ggx.smooth()) return diffuse;
    return lobe * ggx.reflection_pdf(wo, normalize(wo + wi), ggx.cap_scale(wo)) + diffuse;
  }

  BsdfSample<T> sample(const Vec3<T>& wo_, T u_lobe, Point2<T> u) const {
    const Vec3<T> wo = flip_with(wo_, wo_);
    if (!(wo.z > 0)) return {};
    const T lobe = lobe_probability(wo);
    Vec3<T> wi;
    if (!(u_lobe < lobe)) {
      wi = cosine_hemisphere(u);
    } else if (ggx.smooth()) {
      return {.weight = fresnel(wo.z) / lobe, .wi = {-wo_.x, -wo_.y, wo_.z}, .pdf = lobe, .specular = true};
    } else {
      wi = normalize(reflect(wo, ggx.sample_normal(wo, u, ggx.cap_scale(wo))));
    }
    const T density = pdf(wo, wi);
    if (!(density > 0)) return {};
    return {.weight = evaluate(wo, wi) * (wi.z / density), .wi = flip_with(wo_, wi), .pdf = density};
  }

 private:
  Vec3<T> fresnel(T cosine) const { return schlick(f0, schlick_weight(cosine)); }

  Vec3<T> left_for_base(const Vec3<T>& w) const { return albedo->left(w.z, f0); }

  /// By the luminance of the lobe's albedo and of the greatest weight that a sample of the base may have; but
  /// not so seldom that the lobe's samples would weigh much more.
  T lobe_probability(const Vec3<T>& wo) const {
    const Vec3<T> left = left_for_base(wo);
    const T specular = luminance(Vec3<T>(1) - left), diffuse = luminance(base * left);
    return std::max(specular / (specular + diffuse), specular / 4);
  }
};

}  // namespace castray
