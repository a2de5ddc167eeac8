#pragma once

#include "materials/bsdf_sample.h"
#include "materials/descriptor.h"
#include "materials/ggx.h"
#include "materials/surface_values.h"

namespace castray {

const MaterialDescriptor& conductor_descriptor();

/// A metal of constant Fresnel reflectance R: f = R D G2 / (4 cos_i cos_o), or a mirror where smooth.
template <class T>
struct Conductor {
  Vec3<T> reflectance;
  Ggx<T> ggx;

  static const MaterialDescriptor& descriptor() { return conductor_descriptor(); }
  static Conductor make(const SurfaceValues<double>& values, const Material& m, const LobeTables&) {
    return {Vec3<T>(values.color(slot_ks)), {static_cast<T>(values.at(slot_alpha)), m.correlated_masking}};
  }

  Vec3<T> evaluate(const Vec3<T>& wo_, const Vec3<T>& wi_) const {
    const Vec3<T> wo = flip_with(wo_, wo_), wi = flip_with(wo_, wi_);
    if (ggx.smooth() || !(wo.z > 0) || !(wi.z > 0)) return {};
    return reflectance * (ggx.distribution(normalize(wo + wi)) * ggx.shadowing_over_cos(wo, wi));
  }

  T pdf(const Vec3<T>& wo_, const Vec3<T>& wi_) const {
    const Vec3<T> wo = flip_with(wo_, wo_), wi = flip_with(wo_, wi_);
    if (ggx.smooth() || !(wo.z > 0) || !(wi.z > 0)) return 0;
    return ggx.reflection_pdf(wo, normalize(wo + wi), ggx.cap_scale(wo));
  }

  BsdfSample<T> sample(const Vec3<T>& wo_, T, Point2<T> u) const {
    const Vec3<T> wo = flip_with(wo_, wo_);
    if (!(wo.z > 0)) return {};
    if (ggx.smooth())
      return {.weight = reflectance, .wi = {-wo_.x, -wo_.y, wo_.z}, .pdf = 1, .specular = true};
    const T cap = ggx.cap_scale(wo);
    const Vec3<T> h = ggx.sample_normal(wo, u, cap);
    const Vec3<T> wi = normalize(reflect(wo, h));
    if (!(wi.z > 0)) return {};
    return {.weight = reflectance * ggx.reflection_weight(wo, wi, cap),
            .wi = flip_with(wo_, wi),
            .pdf = ggx.reflection_pdf(wo, normalize(wo + wi), cap)};
  }
};

}  // namespace castray
