#pragma once

#include <cmath>

#include "materials/bsdf_sample.h"
#include "materials/descriptor.h"
#include "materials/surface_values.h"

namespace castray {

const MaterialDescriptor& diffuse_descriptor();

/// Lambert's: f = kd / pi.
template <class T>
struct Diffuse {
  Vec3<T> kd;

  static const MaterialDescriptor& descriptor() { return diffuse_descriptor(); }
  static Diffuse make(const SurfaceValues<double>& values, const Material&, const LobeTables&) {
    return {Vec3<T>(values.color(slot_kd))};
  }

  Vec3<T> evaluate(const Vec3<T>& wo, const Vec3<T>& wi) const {
    return wo.z * wi.z > 0 ? kd * (T(1) / pi<T>) : Vec3<T>();
  }

  T pdf(const Vec3<T>& wo, const Vec3<T>& wi) const {
    return wo.z * wi.z > 0 ? std::abs(wi.z) * (T(1) / pi<T>) : T(0);
  }

  BsdfSample<T> sample(const Vec3<T>& wo, T, Point2<T> u) const {
    if (wo.z == 0) return {};
    const Vec3<T> up = cosine_hemisphere(u);
    return {.weight = kd, .wi = {up.x, up.y, wo.z < 0 ? -up.z : up.z}, .pdf = up.z * (T(1) / pi<T>)};
  }
};

}  // namespace castray
