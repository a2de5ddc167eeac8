#pragma once

#include "kernels/api.h"
#include "kernels/vec.h"

namespace castray::CASTRAY_ISA {

/// A point on a light, drawn by power and uniformly by area. `weight` is the emitted radiance over the
/// density of the point with respect to area.
struct LightPoint {
  Vec p, normal, weight;
  Float density;  ///< of the point, per area, as materials have it
  Mask two_sided;
  Float error;
};

/// The light whose stretch of the cumulative probabilities holds u.
CASTRAY_INLINE Uint choose_light(const LightList& list, Float u) {
  Uint low(0u);
  for (uint32_t step = list.count > 1 ? 1u << (31 - __builtin_clz(list.count - 1)) : 0u; step; step >>= 1) {
    const Uint next = low + Uint(step);
    const Mask in_range = next < Uint(list.count);
    const Float start =
        gather(&list.lights->cumulative, select(in_range, next, Uint(0u)) * uint32_t{light_floats});
    low = select(in_range & (start <= u), next, low);
  }
  return low;
}

CASTRAY_INLINE LightPoint sample_light(const LightList& list, Float choice, Float u, Float v) {
  const Uint record = choose_light(list, choice) * uint32_t{light_floats};
  const KernelLight& first = *list.lights;
  const Mask triangle = gather(&first.triangle, record) == Uint(1u);
  const Mask fold = triangle & (u + v > Float(1.f));
  const Float a = select(fold, Float(1.f) - u, u), b = select(fold, Float(1.f) - v, v);
  const Vec p = fma(gather_vec(first.edge1, record), a,
                    fma(gather_vec(first.edge2, record), b, gather_vec(first.origin, record)));
  const Float inverse_density = gather(&first.area, record) / gather(&first.probability, record);
  return {p,
          gather_vec(first.normal, record),
          gather_vec(first.emission, record) * inverse_density,
          gather(&first.density, record),
          gather(&first.two_sided, record) == Uint(1u),
          gather(&first.error, record)};
}

/// The segment from the surface point p to a light point.
struct LightSegment {
  Vec towards;  ///< from p to the point, not of unit length
  Vec end;      ///< the point moved off the light by its error, to p's side
  Float inverse_distance;
  Float solid_angle;  ///< cos' / |x' - x|^2; zero where the light faces away
};
CASTRAY_INLINE LightSegment connect_light(const LightPoint& light, const Vec& p) {
  const Vec towards = light.p - p;
  const Float facing = -dot(light.normal, towards);
  const Float cos_light = select(light.two_sided, abs(facing), max(facing, Float(0.f)));
  const Float distance2 = length_squared(towards);
  const Float inverse = Float(1.f) / sqrt(max(distance2, Float(0x1p-100f)));
  return {towards, fma(light.normal, copy_sign(light.error, facing), light.p), inverse,
          cos_light * inverse * inverse * inverse};
}

}  // namespace castray::CASTRAY_ISA
