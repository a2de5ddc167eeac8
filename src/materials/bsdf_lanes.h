#pragma once

#include "materials/ggx_lanes.h"
#include "wavefront/kernel_api.h"

// The BSDFs of src/shading in lanes: each lane has a material of its own. Directions are in the shading
// frame, whose normal is on the viewer's side, so wo.z > 0.

namespace castray::CASTRAY_ISA {

/// How a surface reflects at a point.
struct Bsdf {
  Uint kind;
  Vec kd, ks;   ///< as in KernelMaterial, kd with its texture
  Float alpha;  ///< 0: smooth
  Float eta;    ///< dielectric: index beyond the surface over that of the viewer's side
  Uint albedo;  ///< microfacet: offset of its table
  const KernelAlbedo* albedos;

  CASTRAY_INLINE Mask is(MaterialKind k) const { return kind == Uint(k); }
  CASTRAY_INLINE Mask smooth() const { return alpha <= Float(0.f); }
};

/// f |cos| of a pair of directions, and the density of sampling the second.
struct BsdfValue {
  Vec f_cos;
  Float pdf;
};

struct BsdfSample {
  Vec wi;
  Vec weight;  ///< f |cos| / pdf; zero: no sample
  Float pdf;
  Mask specular;
  Float eta2;  ///< the scale of radiance by refraction that `weight` holds, inverted
};

CASTRAY_INLINE Vec black() { return {Float(0.f), Float(0.f), Float(0.f)}; }

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
  const Float a0 = gather(b.albedos->a, at), a1 = gather(b.albedos->a, at + 1u);
  const Float b0 = gather(b.albedos->b, at), b1 = gather(b.albedos->b, at + 1u);
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

CASTRAY_INLINE BsdfValue evaluate_diffuse(const Bsdf& b, Vec wi) {
  const Float pdf = wi.z * Float(1.f / pi);
  return {b.kd * pdf, pdf};
}

CASTRAY_INLINE BsdfValue evaluate_conductor(const Bsdf& b, Vec wo, Vec wi) {
  const Vec h = normalize(wo + wi);
  const Float d = ggx_distribution(b.alpha, h);
  const Float cap = ggx_cap_scale(b.alpha, wo);
  return {b.ks * (d * ggx_shadowing_over_cos(b.alpha, wo, wi) * wi.z),
          d / (Float(2.f) * fma(cap, wo.z, ggx_stretched_length(b.alpha, wo)))};
}

CASTRAY_INLINE BsdfValue evaluate_microfacet(const Bsdf& b, Vec wo, Vec wi) {
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

CASTRAY_INLINE BsdfValue evaluate_dielectric(const Bsdf& b, Vec wo, Vec wi) {
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
  return {{kept, kept, kept}, select(possible, pdf, Float(0.f))};
}

CASTRAY_INLINE BsdfValue choose(Mask m, const BsdfValue& a, const BsdfValue& b) {
  return {select(m, a.f_cos, b.f_cos), select(m, a.pdf, b.pdf)};
}

/// f |cos| and density; zero for what a perfectly specular lobe does.
CASTRAY_INLINE BsdfValue evaluate(const Bsdf& b, Vec wo, Vec wi) {
  const BsdfValue nothing{black(), Float(0.f)};
  const Mask above = (wi.z > Float(0.f)) & (wo.z > Float(0.f));
  BsdfValue value = choose(b.is(kind_diffuse), evaluate_diffuse(b, wi), nothing);
  const Mask metal = b.is(kind_conductor) & ~b.smooth();
  if (any(metal)) value = choose(metal, evaluate_conductor(b, wo, wi), value);
  const Mask coated = b.is(kind_microfacet);
  if (any(coated)) value = choose(coated, evaluate_microfacet(b, wo, wi), value);
  value = choose(above, value, nothing);
  const Mask glass = b.is(kind_dielectric) & (wo.z > Float(0.f));
  if (any(glass)) value = choose(glass, evaluate_dielectric(b, wo, wi), value);
  return value;
}

CASTRAY_INLINE Vec cosine_hemisphere(Float u, Float v) {
  const SinCos turn = sincos_turn(v);
  const Float r = sqrt(u);
  return {r * turn.cos, r * turn.sin, sqrt(max(Float(1.f) - u, Float(0.f)))};
}

CASTRAY_INLINE BsdfSample choose(Mask m, const BsdfSample& a, const BsdfSample& b) {
  return {select(m, a.wi, b.wi), select(m, a.weight, b.weight), select(m, a.pdf, b.pdf),
          (m & a.specular) | (~m & b.specular), select(m, a.eta2, b.eta2)};
}

/// A sample whose density has to be evaluated: that of the whole BSDF.
CASTRAY_INLINE BsdfSample weigh(const BsdfValue& value, Vec wi) {
  const Mask valid = value.pdf > Float(0.f);
  return {wi, select(valid, value.f_cos * (Float(1.f) / value.pdf), black()), value.pdf, Mask(false),
          Float(1.f)};
}

CASTRAY_INLINE BsdfSample sample_conductor(const Bsdf& b, Vec wo, Float u, Float v) {
  const Vec h = ggx_sample_normal(b.alpha, wo, u, v, ggx_cap_scale(b.alpha, wo));
  const Vec wi = normalize(reflect(wo, h));
  const BsdfSample rough =
      weigh(choose(wi.z > Float(0.f), evaluate_conductor(b, wo, wi), {black(), Float(0.f)}), wi);
  const BsdfSample mirror{{-wo.x, -wo.y, wo.z}, b.ks, Float(1.f), Mask(true), Float(1.f)};
  return choose(b.smooth(), mirror, rough);
}

CASTRAY_INLINE BsdfSample sample_microfacet(const Bsdf& b, Vec wo, Float choice, Float u, Float v) {
  const Float lobe = lobe_probability(b, lobe_albedo(b, wo.z));
  const Mask to_lobe = choice < lobe;
  const Vec h = ggx_sample_normal(b.alpha, wo, u, v, ggx_cap_scale(b.alpha, wo));
  const Vec wi = select(to_lobe, normalize(reflect(wo, h)), cosine_hemisphere(u, v));
  const BsdfSample rough =
      weigh(choose(wi.z > Float(0.f), evaluate_microfacet(b, wo, wi), {black(), Float(0.f)}), wi);
  const BsdfSample mirror{
      {-wo.x, -wo.y, wo.z}, schlick(b.ks, wo.z) * (Float(1.f) / lobe), lobe, Mask(true), Float(1.f)};
  return choose(to_lobe & b.smooth(), mirror, rough);
}

CASTRAY_INLINE BsdfSample sample_dielectric(const Bsdf& b, Vec wo, Float choice, Float u, Float v) {
  const Mask smooth = b.smooth();
  const Vec up{Float(0.f), Float(0.f), Float(1.f)};
  const Vec h = select(smooth, up, ggx_sample_normal(b.alpha, wo, u, v, Float(1.f)));
  const Float wo_h = dot(wo, h);
  const Float f = fresnel_dielectric(wo_h, b.eta);
  const Mask reflected = choice < f;
  const Vec wi = normalize(select(reflected, reflect(wo, h), refract(wo, h, b.eta)));
  const Mask possible = (reflected & (wi.z > Float(0.f))) | (~reflected & (wi.z < Float(0.f)));
  const Float eta2 = select(reflected, Float(1.f), b.eta * b.eta);
  const Vec above{wi.x, wi.y, abs(wi.z)};
  const Float masking = ggx_shadowing_over_cos(b.alpha, wo, above) * above.z * Float(2.f) *
                        (wo.z + ggx_stretched_length(b.alpha, wo));
  const Float weight = select(possible, select(smooth, Float(1.f), masking) / eta2, Float(0.f));
  const Float pdf = select(smooth, select(reflected, f, Float(1.f) - f), evaluate_dielectric(b, wo, wi).pdf);
  return {wi, {weight, weight, weight}, pdf, smooth, eta2};
}

/// A direction for the path to go on; `choice` picks the lobe.
CASTRAY_INLINE BsdfSample sample(const Bsdf& b, Vec wo, Float choice, Float u, Float v) {
  const Vec about_normal = cosine_hemisphere(u, v);
  BsdfSample s{about_normal, b.kd, about_normal.z * Float(1.f / pi), Mask(false), Float(1.f)};
  const Mask metal = b.is(kind_conductor);
  if (any(metal)) s = choose(metal, sample_conductor(b, wo, u, v), s);
  const Mask coated = b.is(kind_microfacet);
  if (any(coated)) s = choose(coated, sample_microfacet(b, wo, choice, u, v), s);
  const Mask glass = b.is(kind_dielectric);
  if (any(glass)) s = choose(glass, sample_dielectric(b, wo, choice, u, v), s);
  s.weight = select((wo.z > Float(0.f)) & (s.pdf > Float(0.f)), s.weight, black());
  return s;
}

}  // namespace castray::CASTRAY_ISA
