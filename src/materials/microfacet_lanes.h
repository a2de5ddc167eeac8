#pragma once

#include "materials/bsdf_sample_lanes.h"

namespace castray::CASTRAY_ISA {

CASTRAY_INLINE Vec schlick(Vec f0, Float cosine) {
  const Float m = min(max(Float(1.f) - cosine, Float(0.f)), Float(1.f)), m2 = m * m, m5 = m2 * m2 * m;
  return fma(f0, Float(1.f) - m5, Vec{m5, m5, m5});
}

/// The microfacet lobe's directional albedo; see LobeAlbedo.
CASTRAY_INLINE Vec lobe_albedo(const Bsdf& b, Float cosine) {
  const Uint i = to_uint(min(sqrt(cosine) * Float((float)albedo_intervals), Float(albedo_intervals - 1.f)));
  const Float step(1.f / albedo_intervals);
  const Float c0 = square(to_float(i) * step), c1 = square(to_float(i + 1u) * step);
  const Float t = (cosine - c0) / (c1 - c0);
  const Uint at = b.albedo + i;
  const Float a0 = gather(b.albedos, &KernelAlbedo::a, at), a1 = gather(b.albedos, &KernelAlbedo::a, at + 1u);
  const Float b0 = gather(b.albedos, &KernelAlbedo::b, at), b1 = gather(b.albedos, &KernelAlbedo::b, at + 1u);
  const Float base = fma(t, b1 - b0, b0);
  return fma(b.ks, fma(t, a1 - a0, a0), Vec{base, base, base});
}

/// What the microfacet's base gets of light to or from a direction, and how often its lobe is sampled.
CASTRAY_INLINE Vec left_for_base(Vec lobe) {
  return {Float(1.f) - lobe.x, Float(1.f) - lobe.y, Float(1.f) - lobe.z};
}
CASTRAY_INLINE Float lobe_probability(const Bsdf& b, Vec lobe) {
  const Float specular = luminance(lobe);
  return specular / (specular + luminance(b.kd * left_for_base(lobe)));
}

/// A coat over a diffuse base; see microfacet.h.
struct Microfacet : ModelDefaults {
  static constexpr MaterialType type = MaterialType::microfacet;

  CASTRAY_INLINE static BsdfValue evaluate(const Bsdf& b, Vec wo, Vec wi) {
    const Vec lobe_o = lobe_albedo(b, wo.z);
    const Float probability = lobe_probability(b, lobe_o);
    const Vec base =
        b.kd * left_for_base(lobe_o) * left_for_base(lobe_albedo(b, wi.z)) * (wi.z * Float(1.f / pi));
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
    const Float lobe = lobe_probability(b, lobe_albedo(b, wo.z));
    const Mask to_lobe = choice < lobe;
    const Vec h = ggx_sample_normal(b.alpha, wo, u, v, ggx_cap_scale(b.alpha, wo));
    const Vec wi = select(to_lobe, normalize(reflect(wo, h)), cosine_hemisphere(u, v));
    const BsdfSample rough = weigh(choose(wi.z > Float(0.f), evaluate(b, wo, wi), no_value()), wi);
    const BsdfSample mirror{
        {-wo.x, -wo.y, wo.z}, schlick(b.ks, wo.z) * (Float(1.f) / lobe), lobe, Mask(true), Float(1.f)};
    return choose(to_lobe & b.smooth(), mirror, rough);
  }

  /// mix_metal of microfacet.h.
  CASTRAY_INLINE static void finish(const KernelDetail& d, Float* value) {
    const Float metallic = value[slot_metallic];
    for (int c = 0; c < 3; ++c) {
      const Float kd = value[slot_kd + c], ks = fma(kd - value[slot_ks + c], metallic, value[slot_ks + c]);
      value[slot_ks + c] = ks;
      value[slot_kd + c] = kd * (Float(1.f) - metallic) /
                           (Float(1.f) - fma(ks, Float(d.mean_albedo[0]), Float(d.mean_albedo[1])));
    }
  }
};

}  // namespace castray::CASTRAY_ISA
