#pragma once

#include "materials/bsdf_sample_lanes.h"

namespace castray::CASTRAY_ISA {

/// What is reflected of the light that does not pass windows which reflect so much, by transmittance.
CASTRAY_INLINE Float share_mirrored(Float reflectance, const Vec& transmittance) {
  const Float passed = Float(1.f) - reflectance;
  const Float there = reflectance + passed * (Float(1.f) - max_component(transmittance));
  return select(reflectance > Float(0.f), reflectance / there, Float(0.f));
}

/// Glass whose transmittance is kd; see dielectric.h.
struct Dielectric : ModelDefaults {
  static constexpr MaterialType type = MaterialType::dielectric;
  static constexpr bool transmits = true;

  CASTRAY_INLINE static Vec tint(const Vec& passed, Mask reflected) {
    return select(reflected, Vec{Float(1.f), Float(1.f), Float(1.f)}, passed);
  }

  CASTRAY_INLINE static Mask is_window(const Bsdf& b) {
    const Uint traits = gather(b.materials, &KernelMaterial::traits, b.record);
    return ~((traits & uint32_t{trait_window}) == Uint(0u));
  }

  CASTRAY_INLINE static BsdfValue evaluate(const Bsdf& b, Vec wo, Vec wi) {
    const Mask reflection = wi.z > Float(0.f);
    Vec h = wo + wi * select(reflection, Float(1.f), b.eta);
    h = normalize(select(h.z < Float(0.f), -h, h));
    const Float wo_h = dot(wo, h), wi_h = dot(wi, h);
    const Mask possible = ~b.smooth() & (h.z > Float(0.f)) & (wo_h > Float(0.f)) & (wi_h * wi.z > Float(0.f));
    const Float f = fresnel_dielectric(wo_h, b.eta);
    const Float d = ggx_distribution(b.alpha, h);
    const Vec up{wi.x, wi.y, abs(wi.z)};
    const Float shadowing = ggx_shadowing_over_cos(b.alpha, wo, up);
    const Float visible = d / (wo.z + ggx_stretched_length(b.alpha, wo));
    const Float denominator = square(wi_h + wo_h / b.eta);
    const Float transmitted =
        (Float(1.f) - f) * d * Float(4.f) * shadowing * abs(wi_h * wo_h) / (denominator * b.eta * b.eta);
    const Float value = select(reflection, f * d * shadowing, transmitted) * abs(wi.z);
    const Float pdf = select(reflection, f * visible * Float(0.5f),
                             (Float(1.f) - f) * Float(2.f) * wo_h * visible * abs(wi_h) / denominator);
    const Float kept = select(possible, value, Float(0.f));
    return {tint(b.kd, reflection) * kept, select(possible, pdf, Float(0.f))};
  }

  CASTRAY_INLINE static BsdfSample sample(const Bsdf& b, Vec wo, Float choice, Float u, Float v) {
    const Mask smooth = b.smooth();
    const Vec up{Float(0.f), Float(0.f), Float(1.f)};
    const Vec h = select(smooth, up, ggx_sample_normal(b.alpha, wo, u, v, Float(1.f)));
    const Float wo_h = dot(wo, h), eta = abs(b.eta);
    const Float of_surface = fresnel_dielectric(wo_h, eta);
    const Mask thin = b.eta < Float(0.f);
    Float f = select(thin, Float(2.f) * of_surface / (Float(1.f) + of_surface), of_surface);
    Float shared(1.f);
    if (any(thin)) {
      const Mask window = thin & is_window(b);
      shared = select(window, share_mirrored(f, b.kd), shared);
      f = select(window, Float(1.f), f);
    }
    const Mask reflected = choice < f;
    const Vec passed = select(thin, -wo, refract(wo, h, eta));
    const Vec wi = normalize(select(reflected, reflect(wo, h), passed));
    const Mask possible = (reflected & (wi.z > Float(0.f))) | (~reflected & (wi.z < Float(0.f)));
    const Float eta2 = select(reflected | thin, Float(1.f), eta * eta);
    const Vec above{wi.x, wi.y, abs(wi.z)};
    const Float masking = ggx_shadowing_over_cos(b.alpha, wo, above) * above.z * Float(2.f) *
                          (wo.z + ggx_stretched_length(b.alpha, wo));
    const Float weight = select(possible, select(smooth, shared, masking) / eta2, Float(0.f));
    const Float pdf = select(smooth, select(reflected, f, Float(1.f) - f), evaluate(b, wo, wi).pdf);
    return {wi, tint(b.kd, reflected) * weight, pdf, smooth, eta2};
  }
};

}  // namespace castray::CASTRAY_ISA
