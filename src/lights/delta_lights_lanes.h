#pragma once

#include "lights/light_point_lanes.h"
#include "lights/light_records.h"

// lights/delta_lights.h in lanes.

namespace castray::CASTRAY_ISA {

/// A surface point that is to be lit; `one_sided`: only from the side of its normal.
struct LitPoint {
  Vec p, normal;
  Mask one_sided;
};

/// What a light without size sends to a point, if nothing is between.
struct DeltaSample {
  Vec wi, irradiance;
};
CASTRAY_INLINE DeltaSample sample_delta(const KernelDelta& light, Vec p) {
  const Vec at = broadcast(light.at), intensity = broadcast(light.intensity);
  if (light.infinite) return {at, intensity};
  const Vec towards = at - p;
  const Float inverse = Float(1.f) / sqrt(max(length_squared(towards), Float(0x1p-100f)));
  const Vec wi = towards * inverse;
  const Float cosine = -dot(broadcast(light.axis), wi);
  const Float share = max((cosine - Float(light.cos_outer)) * Float(light.inverse_width), Float(0.f));
  return {wi, intensity * (square(min(share, Float(1.f))) * inverse * inverse)};
}

/// By which lights are chosen for a point: 0 only where the light brings nothing.
CASTRAY_INLINE Float importance(const KernelDelta& light, const LitPoint& x) {
  const DeltaSample sample = sample_delta(light, x.p);
  const Float facing = dot(sample.wi, x.normal);
  const Mask hidden = (abs(facing) <= Float(0.f)) | (x.one_sided & (facing < Float(0.f)));
  return select(hidden, Float(0.f), max_component(sample.irradiance));
}

/// Of a light that nothing else finds; greater than any of a BSDF.
inline constexpr float delta_density = 0x1p60f;

/// One of the lights, chosen by what it would bring; as a light point that faces x.
CASTRAY_INLINE LightPoint sample_delta_light(const DeltaList& list, const LitPoint& x, Float u) {
  Float sum(0.f);
  for (uint32_t i = 0; i < list.count; ++i) sum += importance(list.lights[i], x);
  const Float until = u * sum;
  Vec at = black(), wi = black(), irradiance = black();
  Mask infinite(false), chosen(false);
  Float so_far(0.f), of_chosen(0.f);
  for (uint32_t i = 0; i < list.count; ++i) {
    const KernelDelta& light = list.lights[i];
    const Float share = importance(light, x);
    so_far += share;
    const Mask here = ~chosen & (so_far > until);
    if (none(here)) continue;
    const DeltaSample sample = sample_delta(light, x.p);
    chosen = chosen | here;
    at = select(here, broadcast(light.at), at);
    wi = select(here, sample.wi, wi);
    irradiance = select(here, sample.irradiance, irradiance);
    infinite = light.infinite ? infinite | here : infinite;
    of_chosen = select(here, share, of_chosen);
  }
  // Where the point is farther away than the scene reaches, light comes from its direction.
  const Vec towards = at - x.p;
  const Float distance2 = length_squared(towards);
  const Mask far = infinite | (distance2 > Float(beyond_scene * beyond_scene));
  const Float weight = select(chosen, sum / of_chosen, Float(0.f)) * select(far, Float(1.f), distance2);
  return {select(far, wi, at),
          -wi,
          irradiance * weight,
          Float(delta_density),
          Mask(false),
          Float(0.f),
          far,
          Uint(0u)};
}

}  // namespace castray::CASTRAY_ISA
