#pragma once

#include "materials/lobe_albedo_lanes.h"

namespace castray::CASTRAY_ISA {

/// What the coat leaves for the base of light to or from a direction.
CASTRAY_INLINE Vec left_for_base(const Bsdf& b, Float cosine) {
  return left_by_lobe(b.albedos, b.albedo, b.ks, cosine);
}

/// How often the lobe is sampled; see Microfacet of microfacet.h.
CASTRAY_INLINE Float lobe_probability(const Bsdf& b, const Vec& left) {
  const Float specular = luminance(one_minus(left));
  return max(specular / (specular + luminance(b.kd * left)), specular * Float(0.25f));
}

/// A coat over a diffuse base; see microfacet.h.
struct Microfacet : ModelDefaults {
  static constexpr MaterialType type = MaterialType::microfacet;

  CASTRAY_INLINE static BsdfValue evaluate(const Bsdf& b, Vec wo, Vec wi) {
    const Vec left_o = left_for_base(b, wo.z);
    const Float probability = lobe_probability(b, left_o);
    const Vec base = b.kd * left_o * left_for_base(b, wi.z) * (wi.z * Float(1.f / pi));
    const Float base_pdf = (Float(1.f) - probability) * wi.z * Float(1.f / pi);
    const Vec h = normalize(wo + wi);
    const Float d = ggx_distribution(b.alpha, h);
    const Float cap = ggx_cap_scale(b.alpha, wo);
    const Vec lobe = schlick(b.ks, dot(wo, h)) * (d * ggx_shadowing_over_cos(b.alpha, wo, wi) * wi.z);
    const Float lobe_pdf = probability * d / (Float(2.f) * fma(cap, wo.z, ggx_stretched_length(b.alpha, wo)));
    const Mask smooth = b.smooth();
    return {base + select(smooth, black(), lobe), base_pdf + select(smooth, Float(0.f), lobe_pdf)};
  }

  CASTRAY_INLINE static BsdfSample sample(const Bsdf& b, Vec wo, Float choice, Float u, Float v) {
    const Float lobe = lobe_probability(b, left_for_base(b, wo.z));
    const Mask to_lobe = choice < lobe;
    const Vec h = ggx_sample_normal(b.alpha, wo, u, v, ggx_cap_scale(b.alpha, wo));
    const Vec wi = select(to_lobe, normalize(reflect(wo, h)), cosine_hemisphere(u, v));
    const BsdfSample rough = weigh(choose(wi.z > Float(0.f), evaluate(b, wo, wi), no_value()), wi);
    const BsdfSample mirror{
        {-wo.x, -wo.y, wo.z}, schlick(b.ks, wo.z) * (Float(1.f) / lobe), lobe, Mask(true), Float(1.f)};
    return choose(to_lobe & b.smooth(), mirror, rough);
  }

  /// base_under of lobe_albedo.h.
  CASTRAY_INLINE static void finish(const KernelDetail& d, const KernelAlbedo* albedos, Float* value) {
    const Uint albedo = round_alpha_to_row(d, value);
    const auto color = [&](int slot) { return Vec{value[slot], value[slot + 1], value[slot + 2]}; };
    const Vec base = base_under(albedos, albedo, color(slot_kd), color(slot_ks));
    value[slot_kd] = base.x;
    value[slot_kd + 1] = base.y;
    value[slot_kd + 2] = base.z;
  }
};

}  // namespace castray::CASTRAY_ISA
