#pragma once

#include "materials/ggx_lanes.h"
#include "materials/kernel_material.h"

// What the lane models of materials take and give: each X_lanes.h beside a host model X.h is the same model
// in lanes, of which each may have another material. Directions are in the shading frame, whose normal is on
// the viewer's side, so wo.z > 0.

namespace castray::CASTRAY_ISA {

/// How a surface reflects at a point.
struct Bsdf {
  Uint type;    ///< MaterialType
  Vec kd, ks;   ///< the values of slot_kd and slot_ks
  Float alpha;  ///< 0: smooth
  Float eta;    ///< dielectric: index beyond the surface over that of the viewer's side;
                ///< below 0: a thin wall, of index -eta
  Uint albedo;  ///< offset of its lobe's table, where it has one
  const KernelAlbedo* albedos;
  Float own[2];      ///< principled: slot_metal_sheen and slot_coat; in their lanes alone
  Float stretch[2];  ///< where `stretched`: slot_stretch or slot_layered_stretch, 0 in lanes of round lobes
  bool stretched;    ///< whether there are lobes that are not round
  bool scatters_again;                        ///< whether there is a material with that trait
  Uint record;                                ///< offset of the material
  const KernelMaterial *materials, *indices;  ///< as in MaterialTables

  CASTRAY_INLINE Mask is(MaterialType t) const { return type == Uint((uint32_t)t); }
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

CASTRAY_INLINE BsdfValue no_value() { return {black(), Float(0.f)}; }

CASTRAY_INLINE BsdfValue choose(Mask m, const BsdfValue& a, const BsdfValue& b) {
  return {select(m, a.f_cos, b.f_cos), select(m, a.pdf, b.pdf)};
}
CASTRAY_INLINE BsdfSample choose(Mask m, const BsdfSample& a, const BsdfSample& b) {
  return {select(m, a.wi, b.wi), select(m, a.weight, b.weight), select(m, a.pdf, b.pdf),
          (m & a.specular) | (~m & b.specular), select(m, a.eta2, b.eta2)};
}

CASTRAY_INLINE Vec cosine_hemisphere(Float u, Float v) {
  const SinCos turn = sincos_turn(v);
  const Float r = sqrt(u);
  return {r * turn.cos, r * turn.sin, sqrt(max(Float(1.f) - u, Float(0.f)))};
}

/// A sample whose density has to be evaluated: that of the whole BSDF.
CASTRAY_INLINE BsdfSample weigh(const BsdfValue& value, Vec wi) {
  const Mask valid = value.pdf > Float(0.f);
  return {wi, select(valid, value.f_cos * (Float(1.f) / value.pdf), black()), value.pdf, Mask(false),
          Float(1.f)};
}

/// What every model has:
///
///     static constexpr MaterialType type
///     static BsdfValue evaluate(b, wo, wi)            zero for what a perfectly specular lobe does
///     static BsdfSample sample(b, wo, choice, u, v)   a direction to go on; `choice` picks the lobe
///
/// and, where it is other than here:
struct ModelDefaults {
  static constexpr bool transmits = false;  ///< wi may lie below the surface
  /// Which lanes have a density to evaluate.
  CASTRAY_INLINE static Mask has_density(const Bsdf&) { return Mask(true); }
  /// Makes of a point's values, images looked up, those that Bsdf wants; as the host does for constants.
  CASTRAY_INLINE static void finish(const KernelDetail&, const KernelAlbedo*, Float*) {}
};

}  // namespace castray::CASTRAY_ISA
