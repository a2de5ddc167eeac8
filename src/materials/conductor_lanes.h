#pragma once

#include "materials/bsdf_sample_lanes.h"

namespace castray::CASTRAY_ISA {

/// A metal of constant reflectance ks; see conductor.h.
struct Conductor : ModelDefaults {
  static constexpr MaterialType type = MaterialType::conductor;

  CASTRAY_INLINE static Mask has_density(const Bsdf& b) { return ~b.smooth(); }

  CASTRAY_INLINE static BsdfValue evaluate(const Bsdf& b, Vec wo, Vec wi) {
    const Vec h = normalize(wo + wi);
    const Float d = ggx_distribution(b.alpha, h);
    const Float cap = ggx_cap_scale(b.alpha, wo);
    return {b.ks * (d * ggx_shadowing_over_cos(b.alpha, wo, wi) * wi.z),
            d / (Float(2.f) * fma(cap, wo.z, ggx_stretched_length(b.alpha, wo)))};
  }

  CASTRAY_INLINE static BsdfSample sample(const Bsdf& b, Vec wo, Float, Float u, Float v) {
    const Vec h = ggx_sample_normal(b.alpha, wo, u, v, ggx_cap_scale(b.alpha, wo));
    const Vec wi = normalize(reflect(wo, h));
    const BsdfSample rough = weigh(choose(wi.z > Float(0.f), evaluate(b, wo, wi), no_value()), wi);
    const BsdfSample mirror{{-wo.x, -wo.y, wo.z}, b.ks, Float(1.f), Mask(true), Float(1.f)};
    return choose(b.smooth(), mirror, rough);
  }
};

}  // namespace castray::CASTRAY_ISA
