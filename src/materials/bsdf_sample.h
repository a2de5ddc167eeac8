#pragma once

#include "core/warp.h"

namespace castray {

/// What a BSDF's `sample` returns. All weights zero: no sample.
///
/// The contract of every BSDF, tested by one harness (tests/unit/bsdf_test.cpp). Directions are unit vectors
/// in the shading frame, +z the normal, both pointing away from the surface; wo is where the radiance goes.
///
///     Vec3<T> evaluate(wo, wi)   f, per steradian, without the cosine; zero for perfectly specular lobes
///     T pdf(wo, wi)              density of `sample`'s wi per steradian, of its non-specular branches
///     BsdfSample<T> sample(wo, u_lobe, u)
///
/// Either side of the surface may be given: opaque BSDFs are two-sided.
template <class T>
struct BsdfSample {
  Vec3<T> weight{};       ///< f |cos(wi)| / pdf, the probability of the chosen lobe included
  Vec3<T> wi{};           ///< in the shading frame
  T pdf = 0;              ///< what pdf(wo, wi) returns; for a specular sample the lobe's probability
  bool specular = false;  ///< wi is the only direction of its lobe; light sampling cannot find it
  T eta2 = 1;             ///< (n_i / n_o)^2 of a refraction: weight * eta2 is free of the radiance scale

  bool valid() const { return weight.x > 0 || weight.y > 0 || weight.z > 0; }
};

/// The same direction seen with the normal on wo's side.
template <class T>
constexpr Vec3<T> flip_with(const Vec3<T>& wo, const Vec3<T>& w) {
  return wo.z < 0 ? -w : w;
}

}  // namespace castray
