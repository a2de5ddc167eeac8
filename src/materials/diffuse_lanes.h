#pragma once

#include "materials/bsdf_sample_lanes.h"

namespace castray::CASTRAY_ISA {

/// Lambert's; see diffuse.h.
struct Diffuse : ModelDefaults {
  static constexpr MaterialType type = MaterialType::diffuse;

  CASTRAY_INLINE static BsdfValue evaluate(const Bsdf& b, Vec, Vec wi) {
    const Float pdf = wi.z * Float(1.f / pi);
    return {b.kd * pdf, pdf};
  }

  CASTRAY_INLINE static BsdfSample sample(const Bsdf& b, Vec, Float, Float u, Float v) {
    const Vec about_normal = cosine_hemisphere(u, v);
    return {about_normal, b.kd, about_normal.z * Float(1.f / pi), Mask(false), Float(1.f)};
  }
};

}  // namespace castray::CASTRAY_ISA
