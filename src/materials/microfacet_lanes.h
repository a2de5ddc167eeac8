#pragma once

#include "materials/bsdf_sample_lanes.h"

namespace castray::CASTRAY_ISA {

CASTRAY_INLINE Vec schlick(Vec f0, Float cosine) {
  const Float m = min(max(Float(1.f) - cosine, Float(0.f)), Float(1.f)), m2 = m * m, m5 = m2 * m2 * m;
  return fma(f0, Float(1.f) - m5, Vec{m5, m5, m5});
}

CASTRAY_INLINE Vec one_minus(const Vec& v) { return {Float(1.f) - v.x, Float(1.f) - v.y, Float(1.f) - v.z}; }

/// What the coat leaves for the base of light to or from a direction: 1 - E; see LobeAlbedo.
CASTRAY_INLINE Vec left_for_base(const Bsdf& b, Float cosine) {
  const Uint i = to_uint(min(sqrt(cosine) * Float((float)albedo_intervals), Float(albedo_intervals - 1.f)));
  const Float step(1.f / albedo_intervals);
  const Float c0 = square(to_float(i) * step), c1 = square(to_float(i + 1u) * step);
  const Float t = (cosine - c0) / (c1 - c0);
  const Uint at = b.albedo + i;
  const Float a0 = gather(b.albedos, &KernelAlbedo::a, at), a1 = gather(b.albedos, &KernelAlbedo::a, at + 1u);
  const Float lost0 = gather(b.albedos, &KernelAlbedo::lost, at),
              lost1 = gather(b.albedos, &KernelAlbedo::lost, at + 1u);
  const Float lost = fma(t, lost1 - lost0, lost0);
  return fma(one_minus(b.ks), fma(t, a1 - a0, a0), Vec{lost, lost, lost});
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

  /// mix_metal of microfacet.h; where an image gives alpha, that of the nearest row of LobeAlbedoRows.
  CASTRAY_INLINE static void finish(const KernelDetail& d, const KernelAlbedo* albedos, Float* value) {
    Uint at(d.albedo);
    if (d.albedo_rows > 0) {
      const Uint row = to_uint(fma(sqrt(value[slot_alpha]), Float(d.albedo_rows), Float(0.5f)));
      const Float roughness = to_float(row) * Float(1.f / albedo_row_steps);
      value[slot_alpha] = roughness * roughness;
      at = at + row * uint32_t{albedo_floats};
    }
    const Float mean_a = gather(albedos, &KernelAlbedo::mean_a, at),
                mean_lost = gather(albedos, &KernelAlbedo::mean_lost, at);
    const Float metallic = value[slot_metallic];
    for (int c = 0; c < 3; ++c) {
      const Float kd = value[slot_kd + c], ks = fma(kd - value[slot_ks + c], metallic, value[slot_ks + c]);
      const Float left = fma(Float(1.f) - ks, mean_a, mean_lost);
      value[slot_ks + c] = ks;
      value[slot_kd + c] = kd * (Float(1.f) - metallic) / max(left, Float(least_left_for_base));
    }
  }
};

}  // namespace castray::CASTRAY_ISA
