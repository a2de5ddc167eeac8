#pragma once

#include <algorithm>
#include <iterator>

#include "materials/bsdf_sample.h"
#include "materials/conductor.h"
#include "materials/descriptor.h"
#include "materials/ggx.h"
#include "materials/lobe_albedo.h"
#include "materials/surface_values.h"

namespace castray {

const MaterialDescriptor& principled_descriptor();

/// GGX's width of a clear coat of this roughness.
inline double clearcoat_alpha(double roughness) {
  return std::max(roughness * roughness, double{least_clearcoat_alpha});
}

/// Straight on, of a coat of this index.
inline double reflectance_of_coat(double ior) {
  if (ior == 1.5) return 0.04;  // free of rounding
  const double r = (ior - 1) / (ior + 1);
  return r * r;
}

/// Whether the albedo of a material's clear coat is looked up by the roughness of an image (LobeAlbedoRows);
/// and the row of a roughness.
inline bool has_clearcoat_rows(const Material& m) {
  return m.type == MaterialType::principled && m.map(SurfaceParameter::clearcoat_roughness).used();
}
inline int clearcoat_row(double roughness) { return LobeAlbedoRows::row_of(clearcoat_alpha(roughness)); }

/// A blend of metal and coated base under sheen and a clear coat, the parameters of Burley 2012:
///
///     f = c f_c + C(cos_i) C(cos_o) (s (1 - wi.h)^5 + S(cos_i) S(cos_o) f_b),    s = sheen (1 - metallic)
///     f_b = F D G2 / (4 cos_i cos_o) + (1 - metallic) kd / pi (1 - E(cos_i)) (1 - E(cos_o)) / (1 - E_mean)
///
/// and, where that is asked for, metallic times scattered_again of facets with F0 = kd.
/// F is Schlick's term with F0 = ks (1 - metallic) + kd metallic; where the metal has an index, metallic
/// times Fresnel's term of it stands for the metal's part. E is the albedo of a lobe with F0 = ks, as in
/// Microfacet. f_c is a GGX lobe with F0 by the coat's index. C and S are what clear coat and sheen leave of
/// light to or from a direction, 1 - their albedo: so f is reciprocal and never reflects more than it
/// receives.
template <class T>
struct Principled {
  Vec3<T> base;  ///< kd (1 - metallic) / (1 - E_mean)
  Vec3<T> ks, f0;
  Vec3<T> scattered;  ///< metallic times scattered_again, or 0
  T sheen, clearcoat, clearcoat_f0;
  T metal = 0;         ///< metallic, where Fresnel's term follows from the index
  Vec3<T> eta{}, k{};  ///< that index
  Ggx<T> ggx, coat;
  const LobeAlbedo *albedo, *coat_albedo;  ///< of ggx.alpha and coat.alpha; not owned

  static const MaterialDescriptor& descriptor() { return principled_descriptor(); }
  static Principled make(const SurfaceValues<double>& values, const Material& m, const LobeTables& lobes) {
    const Vec3d kd = values.color(slot_kd), ks = values.color(slot_ks);
    const double metallic = values.at(slot_metallic);
    return {
        .base = Vec3<T>(base_under(kd, ks, *lobes.own) * (1 - metallic)),
        .ks = Vec3<T>(ks),
        .f0 = Vec3<T>(ks + (kd - ks) * metallic),
        .scattered = m.multiple_scattering ? Vec3<T>(scattered_again(mean_schlick(kd), *lobes.own) * metallic)
                                           : Vec3<T>(),
        .sheen = static_cast<T>(values.at(slot_sheen) * (1 - metallic)),
        .clearcoat = static_cast<T>(values.at(slot_clearcoat)),
        .clearcoat_f0 = static_cast<T>(reflectance_of_coat(m.clearcoat_ior)),
        .metal = m.has_index() ? static_cast<T>(metallic) : T(0),
        .eta = Vec3<T>(m.eta),
        .k = Vec3<T>(m.k),
        .ggx = {static_cast<T>(values.at(slot_alpha)), m.correlated_masking,
                static_cast<T>(lobe_aspect(m, values))},
        .coat = {static_cast<T>(clearcoat_alpha(values.at(slot_clearcoat_roughness))), m.correlated_masking},
        .albedo = lobes.own,
        .coat_albedo = lobes.clearcoat};
  }

  Vec3<T> evaluate(const Vec3<T>& wo_, const Vec3<T>& wi_) const {
    const Vec3<T> wo = flip_with(wo_, wo_), wi = flip_with(wo_, wi_);
    if (!(wo.z > 0) || !(wi.z > 0)) return {};
    const Vec3<T> h = normalize(wo + wi);
    const T s = schlick_weight(dot(wo, h));
    Vec3<T> f = base * albedo->left(wo.z, ks) * albedo->left(wi.z, ks) * (T(1) / pi<T>);
    if (scatters_again()) f += scattered * (lost(wo) * lost(wi) / pi<T>);
    if (!ggx.smooth()) f = f + fresnel(dot(wo, h)) * (ggx.distribution(h) * ggx.shadowing_over_cos(wo, wi));
    f = f * (left_by_sheen(wo) * left_by_sheen(wi)) + Vec3<T>(sheen * s);
    const T lobe = coat.distribution(h) * coat.shadowing_over_cos(wo, wi);
    const T reflected = clearcoat * schlick(Vec3<T>(clearcoat_f0), s).x * lobe;
    return f * (left_by_coat(wo) * left_by_coat(wi)) + Vec3<T>(reflected);
  }

  T pdf(const Vec3<T>& wo_, const Vec3<T>& wi_) const {
    const Vec3<T> wo = flip_with(wo_, wo_), wi = flip_with(wo_, wi_);
    if (!(wo.z > 0) || !(wi.z > 0)) return 0;
    const Shares share = shares(wo);
    const Vec3<T> h = normalize(wo + wi);
    const T density = share.coat * coat.reflection_pdf(wo, h, coat.cap_scale(wo)) +
                      (T(1) - share.coat - share.lobe) * wi.z * (T(1) / pi<T>);
    if (ggx.smooth()) return density;
    return density + share.lobe * ggx.reflection_pdf(wo, h, ggx.cap_scale(wo));
  }

  BsdfSample<T> sample(const Vec3<T>& wo_, T u_lobe, Point2<T> u) const {
    const Vec3<T> wo = flip_with(wo_, wo_);
    if (!(wo.z > 0)) return {};
    const Shares share = shares(wo);
    const bool of_coat = u_lobe < share.coat, of_lobe = !of_coat && u_lobe < share.coat + share.lobe;
    if (of_lobe && ggx.smooth()) {
      const T passed = left_by_coat(wo) * left_by_sheen(wo);
      return {.weight = fresnel(wo.z) * (passed * passed / share.lobe),
              .wi = {-wo_.x, -wo_.y, wo.z},
              .pdf = share.lobe,
              .specular = true};
    }
    const Ggx<T>& facets = of_coat ? coat : ggx;
    const Vec3<T> wi = of_coat || of_lobe
                           ? normalize(reflect(wo, facets.sample_normal(wo, u, facets.cap_scale(wo))))
                           : cosine_hemisphere(u);
    const T density = pdf(wo, wi);
    if (!(density > 0)) return {};
    return {.weight = evaluate(wo, wi) * (wi.z / density), .wi = flip_with(wo_, wi), .pdf = density};
  }

 private:
  Vec3<T> fresnel(T cosine) const {
    const T s = schlick_weight(cosine);
    if (!(metal > 0)) return schlick(f0, s);
    const Vec3<T> of_metal{fresnel_conductor(cosine, eta.x, k.x), fresnel_conductor(cosine, eta.y, k.y),
                           fresnel_conductor(cosine, eta.z, k.z)};
    return schlick(ks, s) * (T(1) - metal) + of_metal * metal;
  }

  bool scatters_again() const { return max_component(scattered) > 0; }
  /// 1 - E of facets that reflect all.
  T lost(const Vec3<T>& w) const { return albedo->left(w.z, Vec3<T>(1)).x; }

  T left_by_sheen(const Vec3<T>& w) const {
    T albedo_of_sheen = 0;
    for (std::size_t i = std::size(sheen_albedo_terms); i-- > 0;)
      albedo_of_sheen = albedo_of_sheen * w.z + T(sheen_albedo_terms[i]);
    return T(1) - sheen * albedo_of_sheen;
  }
  T left_by_coat(const Vec3<T>& w) const {
    return T(1) - clearcoat * (T(1) - coat_albedo->left(w.z, Vec3<T>(clearcoat_f0)).x);
  }

  /// How often clear coat and inner lobe are sampled; the rest is the base's.
  struct Shares {
    T coat, lobe;
  };

  /// By albedo, as in Microfacet: neither so seldom that its samples would weigh much more.
  Shares shares(const Vec3<T>& wo) const {
    const Vec3<T> left = albedo->left(wo.z, ks), left_of_lobe = albedo->left(wo.z, f0);
    const T through_sheen = left_by_sheen(wo), through_coat = left_by_coat(wo);
    const T lobe = luminance(Vec3<T>(1) - left_of_lobe) * through_sheen;
    T diffuse = luminance(base * left);
    if (scatters_again()) diffuse += luminance(scattered) * lost(wo) * T(albedo->mean().lost);
    const T below = diffuse * through_sheen + (T(1) - through_sheen);
    const T of_lobe = std::max(lobe / (lobe + below), lobe / 4);
    const T coat_reflects = T(1) - through_coat;
    const T of_coat =
        std::max(coat_reflects / (coat_reflects + through_coat * (lobe + below)), coat_reflects / 4);
    return {of_coat, of_lobe * (T(1) - of_coat)};
  }
};

}  // namespace castray
