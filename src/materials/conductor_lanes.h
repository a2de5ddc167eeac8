#pragma once

#include "materials/lobe_albedo_lanes.h"

namespace castray::CASTRAY_ISA {

/// fresnel_conductor of conductor.h.
CASTRAY_INLINE Float fresnel_conductor(Float cosine, Float eta, Float k) {
  const Float cos2 = square(cosine), sin2 = max(Float(1.f) - cos2, Float(0.f));
  const Float eta2 = eta * eta, k2 = k * k, difference = eta2 - k2 - sin2;
  const Float sum = sqrt(fma(difference, difference, Float(4.f) * eta2 * k2));
  const Float a = sqrt(max(Float(0.5f) * (sum + difference), Float(0.f)));
  const Float along = sum + cos2, across = Float(2.f) * a * cosine;
  const Float p = fma(cos2, sum, sin2 * sin2), q = across * sin2;
  return (along - across) * p / ((along + across) * (p + q));
}

/// A metal; see conductor.h. ks is its reflectance, kd is scattered_again.
struct Conductor : ModelDefaults {
  static constexpr MaterialType type = MaterialType::conductor;

  CASTRAY_INLINE static Mask has_density(const Bsdf& b) { return ~b.smooth(); }

  CASTRAY_INLINE static Vec fresnel(const Bsdf& b, Float cosine) {
    return b.indices ? fresnel_by_index(b, cosine) : b.ks;
  }

  /// Lanes with light that facets reflect more than once.
  CASTRAY_INLINE static Mask scatters_again(const Bsdf& b) {
    return b.is(type) & (max_component(b.kd) > Float(0.f)) & ~b.smooth();
  }

  /// 1 - E of facets that reflect all.
  CASTRAY_INLINE static Float lost(const Bsdf& b, Float cosine) {
    return lost_by_lobe(b.albedos, b.albedo, cosine);
  }

  CASTRAY_INLINE static Float lobe_probability(const Bsdf& b, Float lost_o) {
    const Float once = luminance(b.ks) * (Float(1.f) - lost_o);
    const Float again = luminance(b.kd) * lost_o * gather(b.albedos, &KernelAlbedo::mean_lost, b.albedo);
    return select(once > Float(0.f), once / (once + again), Float(1.f));
  }

  CASTRAY_INLINE static BsdfValue evaluate(const Bsdf& b, Vec wo, Vec wi) {
    const BsdfValue once = b.stretched ? stretched_once(b, wo, wi) : once_by(b, b.alpha, wo, wi);
    const Mask again = scatters_again(b);
    return none(again) ? once : choose(again, with_scattered_again(b, wo, wi, once), once);
  }

  CASTRAY_INLINE static BsdfSample sample(const Bsdf& b, Vec wo, Float choice, Float u, Float v) {
    const Vec h = b.stretched ? stretched_normal(b, wo, u, v)
                              : ggx_sample_normal(b.alpha, wo, u, v, ggx_cap_scale(b.alpha, wo));
    Vec wi = normalize(reflect(wo, h));
    if (const Mask again = scatters_again(b); any(again))
      wi = select(again & ~(choice < lobe_probability(b, lost(b, wo.z))), cosine_hemisphere(u, v), wi);
    const BsdfSample rough = weigh(choose(wi.z > Float(0.f), evaluate(b, wo, wi), no_value()), wi);
    const BsdfSample mirror{{-wo.x, -wo.y, wo.z}, fresnel(b, wo.z), Float(1.f), Mask(true), Float(1.f)};
    return choose(b.smooth(), mirror, rough);
  }

  CASTRAY_INLINE static void finish(const KernelDetail& d, const KernelAlbedo* albedos, Float* value) {
    if (!d.multiple_scattering) return;
    const Float lost = gather(albedos, &KernelAlbedo::mean_lost, round_alpha_to_row(d, value));
    for (int c = 0; c < 3; ++c) {
      const Float mean = d.mean_fresnel[c] > 0 ? Float(d.mean_fresnel[c]) : value[slot_ks + c];
      value[slot_kd + c] = scattered_again(mean, lost);
    }
  }

 private:
  /// Reflected once, by facets of this width: Float, or GgxWidths.
  template <class Alpha>
  CASTRAY_INLINE static BsdfValue once_by(const Bsdf& b, const Alpha& alpha, Vec wo, Vec wi) {
    const Vec h = normalize(wo + wi);
    const Float d = ggx_distribution(alpha, h);
    const Float cap = ggx_cap_scale(alpha, wo);
    return {fresnel(b, dot(wo, h)) * (d * ggx_shadowing_over_cos(alpha, wo, wi) * wi.z),
            d / (Float(2.f) * fma(cap, wo.z, ggx_stretched_length(alpha, wo)))};
  }

  CASTRAY_INLINE static GgxWidths widths(const Bsdf& b) {
    return ggx_widths(b.alpha, b.stretch[0], b.stretch[1]);
  }

  // Not inlined: few scenes need them.

  static __attribute__((noinline)) BsdfValue stretched_once(const Bsdf& b, Vec wo, Vec wi) {
    return once_by(b, widths(b), wo, wi);
  }
  static __attribute__((noinline)) Vec stretched_normal(const Bsdf& b, Vec wo, Float u, Float v) {
    return ggx_sample_normal(widths(b), wo, u, v, ggx_cap_scale(widths(b), wo));
  }

  static __attribute__((noinline)) Vec fresnel_by_index(const Bsdf& b, Float cosine) {
    const Vec eta = gather_vec(b.indices, &KernelMaterial::eta, b.record),
              k = gather_vec(b.indices, &KernelMaterial::k, b.record);
    const Vec exact{fresnel_conductor(cosine, eta.x, k.x), fresnel_conductor(cosine, eta.y, k.y),
                    fresnel_conductor(cosine, eta.z, k.z)};
    return select(eta.x > Float(0.f), exact, b.ks);
  }

  static __attribute__((noinline)) BsdfValue with_scattered_again(const Bsdf& b, Vec wo, Vec wi,
                                                                  BsdfValue once) {
    const Float lost_o = lost(b, wo.z), p = lobe_probability(b, lost_o), cosine = wi.z * Float(1.f / pi);
    return {once.f_cos + b.kd * (lost_o * lost(b, wi.z) * cosine), p * once.pdf + (Float(1.f) - p) * cosine};
  }
};

}  // namespace castray::CASTRAY_ISA
