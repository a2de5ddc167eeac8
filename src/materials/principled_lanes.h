#pragma once

#include "materials/conductor_lanes.h"

namespace castray::CASTRAY_ISA {

struct Pair {
  Float first, second;
};
CASTRAY_INLINE Float pack(Pair p) {
  const auto bits = [](Float x) { return to_uint(fma(x, Float(most_of_pair), Float(0.5f))); };
  return as_float(bits(p.first) | bits(p.second) << 16);
}
CASTRAY_INLINE Pair unpack(Float packed) {
  const Uint bits = as_uint(packed);
  return {to_float(bits & Uint(0xffffu)) / Float(most_of_pair), to_float(bits >> 16) / Float(most_of_pair)};
}

/// Metal and coated base under sheen and a clear coat; see principled.h. Its functions are calls, with all by
/// value: inlined, their many numbers would take the registers of all other models.
struct Principled : ModelDefaults {
  static constexpr MaterialType type = MaterialType::principled;

  static __attribute__((noinline)) BsdfValue evaluate(Bsdf b, Vec wo, Vec wi) {
    return Layers(b, wo).evaluate(wi);
  }

  static __attribute__((noinline)) BsdfSample sample(Bsdf b, Vec wo, Float choice, Float u, Float v) {
    const Layers layers(b, wo);
    const Mask of_coat = choice < layers.coat_share;
    const Mask of_lobe = ~of_coat & (choice < layers.coat_share + layers.lobe_share);
    const Float alpha = select(of_coat, layers.coat_alpha, b.alpha);
    const Vec h = b.stretched ? sample_stretched(b, alpha, of_coat, wo, u, v)
                              : ggx_sample_normal(alpha, wo, u, v, ggx_cap_scale(alpha, wo));
    const Vec wi = select(of_coat | of_lobe, normalize(reflect(wo, h)), cosine_hemisphere(u, v));
    const BsdfSample rough = weigh(choose(wi.z > Float(0.f), layers.evaluate(wi), no_value()), wi);
    const Float passed = layers.left_by_coat(wo) * layers.left_by_sheen(wo);
    const BsdfSample mirror{{-wo.x, -wo.y, wo.z},
                            layers.fresnel(wo.z) * (passed * passed / layers.lobe_share),
                            layers.lobe_share,
                            Mask(true),
                            Float(1.f)};
    return choose(of_lobe & b.smooth(), mirror, rough);
  }

  CASTRAY_INLINE static void finish(const KernelDetail& d, const KernelAlbedo*, Float* value) {
    round_alpha_to_row(d, value);
    Float& coat = value[slot_clearcoat_roughness];
    const Float steps(d.clearcoat_rows);
    const Float least = sqrt(Float(least_clearcoat_alpha));
    if (d.clearcoat_rows > 0) coat = to_float(to_uint(fma(max(coat, least), steps, Float(0.5f)))) / steps;
    value[slot_metal_sheen] = pack({value[slot_metallic], value[slot_sheen]});
    value[slot_coat] = pack({value[slot_clearcoat], coat});
  }

 private:
  /// Fresnel's term where the metal has an index: `metallic` times its own, and the rest of the base's.
  static __attribute__((noinline)) Vec with_index(const KernelMaterial* indices, Uint record, Float metallic,
                                                  Float cosine, Vec of_base, Vec by_schlick) {
    const Vec eta = gather_vec(indices, &KernelMaterial::eta, record),
              k = gather_vec(indices, &KernelMaterial::k, record);
    const Vec metal{fresnel_conductor(cosine, eta.x, k.x), fresnel_conductor(cosine, eta.y, k.y),
                    fresnel_conductor(cosine, eta.z, k.z)};
    return select(eta.x > Float(0.f), fma(metal, metallic, of_base * (Float(1.f) - metallic)), by_schlick);
  }

  /// A facet of the coat, which is round, or of the inner lobe.
  CASTRAY_INLINE static Vec sample_stretched(const Bsdf& b, Float alpha, Mask of_coat, Vec wo, Float u,
                                             Float v) {
    const Float round(0.f);
    const GgxWidths widths =
        ggx_widths(alpha, select(of_coat, round, b.stretch[0]), select(of_coat, round, b.stretch[1]));
    return ggx_sample_normal(widths, wo, u, v, ggx_cap_scale(widths, wo));
  }

  /// The layers as they are seen from wo.
  struct Layers {
    const Bsdf& b;
    Vec wo, f0, base, left_o;
    Vec scattered;  ///< see principled.h; only set where some material has it
    Float sheen, coat, coat_f0{0.f}, coat_alpha{1.f}, coat_share{0.f}, lobe_share;
    Uint coat_albedo{0u};
    bool coated, based;  ///< whether some lane has a coat, or a base; else they are skipped

    CASTRAY_INLINE Layers(const Bsdf& bsdf, Vec from) : b(bsdf), wo(from) {
      const auto [metallic, cloth] = unpack(b.own[0]);
      const auto [covered, roughness] = unpack(b.own[1]);
      const Float rest = Float(1.f) - metallic;
      f0 = fma(b.kd - b.ks, metallic, b.ks);
      base = base_under(b.albedos, b.albedo, b.kd, b.ks) * rest;
      sheen = cloth * rest;
      coat = covered;
      coated = any(b.is(type) & (covered > Float(0.f)));
      based = any(b.is(type) & (max_component(base) > Float(0.f)));
      left_o = based ? left_by_lobe(b.albedos, b.albedo, b.ks, wo.z) : black();
      if (coated) find_coat(roughness);
      if (b.scatters_again) find_scattered(metallic);
      find_shares();
    }

    CASTRAY_INLINE void find_coat(Float roughness) {
      coat_f0 = gather(b.materials, &KernelMaterial::clearcoat_f0, b.record);
      coat_alpha = max(square(roughness), Float(least_clearcoat_alpha));
      const Float rows = gather(b.materials, &KernelMaterial::clearcoat_rows, b.record);
      coat_albedo = gather(b.materials, &KernelMaterial::clearcoat_albedo, b.record) +
                    to_uint(fma(roughness, rows, Float(0.5f))) * uint32_t{albedo_floats};
    }

    CASTRAY_INLINE void find_scattered(Float metallic) {
      const Float lost = mean_lost(), part(1.f / 21);
      const Vec mean = fma(one_minus(b.kd), part, b.kd);  // of Schlick's term
      const Vec again{scattered_again(mean.x, lost), scattered_again(mean.y, lost),
                      scattered_again(mean.z, lost)};
      const Uint traits = gather(b.materials, &KernelMaterial::traits, b.record);
      const Mask none = (traits & uint32_t{trait_scatters_again}) == Uint(0u);
      scattered = select(none, black(), again * metallic);
    }
    CASTRAY_INLINE Float mean_lost() const { return gather(b.albedos, &KernelAlbedo::mean_lost, b.albedo); }
    CASTRAY_INLINE Float lost(Vec w) const { return lost_by_lobe(b.albedos, b.albedo, w.z); }

    CASTRAY_INLINE void find_shares() {
      const Float through_sheen = left_by_sheen(wo), through_coat = left_by_coat(wo), quarter(0.25f);
      const Float lobe = luminance(one_minus(left_by_lobe(b.albedos, b.albedo, f0, wo.z))) * through_sheen;
      Float diffuse = luminance(base * left_o);
      if (b.scatters_again) diffuse = diffuse + luminance(scattered) * lost(wo) * mean_lost();
      const Float below = fma(diffuse, through_sheen, Float(1.f) - through_sheen);
      const Float reflected = Float(1.f) - through_coat;
      if (coated)
        coat_share = max(reflected / fma(through_coat, lobe + below, reflected), reflected * quarter);
      lobe_share = max(lobe / (lobe + below), lobe * quarter) * (Float(1.f) - coat_share);
    }

    CASTRAY_INLINE BsdfValue evaluate(Vec wi) const {
      const Vec h = normalize(wo + wi);
      const Float wo_h = dot(wo, h);
      const Lobe inner =
          b.stretched ? lobe(ggx_widths(b.alpha, b.stretch[0], b.stretch[1]), h, wi) : lobe(b.alpha, h, wi);
      Vec diffuse = black();
      if (based) diffuse = base * left_o * left_by_lobe(b.albedos, b.albedo, b.ks, wi.z) * Float(1.f / pi);
      if (b.scatters_again) diffuse = diffuse + scattered * (lost(wo) * lost(wi) * Float(1.f / pi));
      const Mask smooth = b.smooth();
      const Vec under = diffuse + select(smooth, black(), fresnel(wo_h) * inner.value);
      const Float cloth = sheen * schlick(black(), wo_h).x;
      const Vec through = fma(under, left_by_sheen(wo) * left_by_sheen(wi), Vec{cloth, cloth, cloth});
      const Float base_share = Float(1.f) - coat_share - lobe_share,
                  of_base = base_share * wi.z * Float(1.f / pi),
                  of_lobe = select(smooth, Float(0.f), lobe_share * inner.pdf);
      if (!coated) return {through * wi.z, of_base + of_lobe};
      const Lobe outer = lobe(coat_alpha, h, wi);
      const Float reflected = coat * schlick(coat_color(), wo_h).x * outer.value;
      const Vec f = fma(through, left_by_coat(wo) * left_by_coat(wi), Vec{reflected, reflected, reflected});
      return {f * wi.z, coat_share * outer.pdf + of_base + of_lobe};
    }

    CASTRAY_INLINE Vec fresnel(Float cosine) const {
      const Vec by_schlick = schlick(f0, cosine);
      if (!b.indices) return by_schlick;
      return with_index(b.indices, b.record, unpack(b.own[0]).first, cosine, schlick(b.ks, cosine),
                        by_schlick);
    }

    CASTRAY_INLINE Float left_by_sheen(Vec w) const {
      Float albedo(sheen_albedo_terms[4]);
      for (int i = 3; i >= 0; --i) albedo = fma(albedo, w.z, Float(sheen_albedo_terms[i]));
      return Float(1.f) - sheen * albedo;
    }
    CASTRAY_INLINE Float left_by_coat(Vec w) const {
      if (!coated) return Float(1.f);
      const Vec left = left_by_lobe(b.albedos, coat_albedo, coat_color(), w.z);
      return Float(1.f) - coat * (Float(1.f) - left.x);
    }

   private:
    struct Lobe {
      Float value, pdf;  ///< without Fresnel's term
    };
    template <class Alpha>
    CASTRAY_INLINE Lobe lobe(const Alpha& alpha, Vec h, Vec wi) const {
      return {ggx_distribution(alpha, h) * ggx_shadowing_over_cos(alpha, wo, wi),
              ggx_reflection_pdf(alpha, wo, h, ggx_cap_scale(alpha, wo))};
    }
    CASTRAY_INLINE Vec coat_color() const { return {coat_f0, coat_f0, coat_f0}; }
  };
};

}  // namespace castray::CASTRAY_ISA
