#pragma once

#include "geometry/hit_point_lanes.h"
#include "lights/light_choice_lanes.h"
#include "lights/rectangle_lanes.h"

namespace castray::CASTRAY_ISA {

/// A point on a light. `weight` is the emitted radiance over the density with which the point was drawn,
/// with respect to area.
struct LightPoint {
  Vec p, normal, weight;
  Float density;  ///< per area, of a choice by power and area: what shares with BSDF sampling go by
  Mask two_sided;
  Float error;
};

/// The light whose stretch of the cumulative probabilities holds u.
CASTRAY_INLINE Uint choose_by_power(const LightList& list, Float u) {
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

/// One of the lights, for the receiver. Of u, `deep` serves where u's digits do not suffice.
CASTRAY_INLINE LightChoice choose_light(const LightList& list, Float u, Float deep,
                                        const Receiver& receiver) {
  if (list.cut_count > 0) return choose_by_importance(list, u, deep, receiver);
  if (list.count == 1) return {Uint(0u), Float(1.f)};
  const Uint light = choose_by_power(list, u);
  return {light, gather(&list.lights->probability, light * uint32_t{light_floats})};
}

CASTRAY_INLINE Float in_all_lanes(float v) { return Float(v); }
CASTRAY_INLINE Uint in_all_lanes(uint32_t v) { return Uint(v); }

/// A KernelLight in each lane.
struct Light {
  Vec origin, edge1, edge2, normal, emission;
  Float area, error, density;
  Mask triangle, two_sided, rectangle;
};
template <class Field>
CASTRAY_INLINE Light read_light(const KernelLight& first, Field field) {
  const auto vec = [&](const float* v) { return Vec{field(v), field(v + 1), field(v + 2)}; };
  const auto flag = [&](const uint32_t& v) { return field(&v) == Uint(1u); };
  return {vec(first.origin),    vec(first.edge1),      vec(first.edge2),     vec(first.normal),
          vec(first.emission),  field(&first.area),    field(&first.error),  field(&first.density),
          flag(first.triangle), flag(first.two_sided), flag(first.rectangle)};
}
CASTRAY_INLINE Light light_of(const LightList& list, Uint light) {
  if (list.count == 1) return read_light(*list.lights, [](const auto* v) { return in_all_lanes(*v); });
  const Uint record = light * uint32_t{light_floats};
  return read_light(*list.lights, [&](const auto* v) { return gather(v, record); });
}

/// A point on a light. `choice` and `deep` choose the light, u and v the point.
CASTRAY_INLINE LightPoint sample_light(const LightList& list, const Receiver& receiver, Float choice,
                                       Float deep, Float u, Float v) {
  const LightChoice chosen = choose_light(list, choice, deep, receiver);
  const Light light = light_of(list, chosen.light);
  const Mask fold = light.triangle & (u + v > Float(1.f));
  Float a = select(fold, Float(1.f) - u, u), b = select(fold, Float(1.f) - v, v), area = light.area;
  if (list.by_solid_angle) {
    const RectanglePoint seen =
        sample_seen_rectangle({light.origin - receiver.p, light.edge1, light.edge2, light.normal}, u, v);
    const Mask can = seen.valid & light.rectangle;
    a = select(can, seen.a, a);
    b = select(can, seen.b, b);
    area = select(can, seen.inverse_density, area);
  }
  const Vec p = fma(light.edge1, a, fma(light.edge2, b, light.origin));
  const Float inverse_density =
      select(chosen.probability > Float(0.f), area / chosen.probability, Float(0.f));
  return {p, light.normal, light.emission * inverse_density, light.density, light.two_sided, light.error};
}

/// The segment from the surface point p to a light point.
struct LightSegment {
  Vec towards;  ///< from p to the point, not of unit length
  Vec end;      ///< the point moved off the light by its error, to p's side
  Vec normal;   ///< of the light, to p's side
  Float inverse_distance;
  Float solid_angle;  ///< cos' / |x' - x|^2; zero where the light faces away
};
CASTRAY_INLINE LightSegment connect_light(const LightPoint& light, const Vec& p) {
  const Vec towards = light.p - p;
  const Float facing = -dot(light.normal, towards);
  const Float cos_light = select(light.two_sided, abs(facing), max(facing, Float(0.f)));
  const Float distance2 = length_squared(towards);
  const Float inverse = Float(1.f) / sqrt(max(distance2, Float(0x1p-100f)));
  const Vec normal{flip_by_sign(light.normal.x, facing), flip_by_sign(light.normal.y, facing),
                   flip_by_sign(light.normal.z, facing)};
  return {towards, fma(normal, light.error, light.p), normal, inverse,
          cos_light * inverse * inverse * inverse};
}

/// A segment as it is traced.
struct Segment {
  Vec o, d;
};

/// The segment between a light point and p, which is off its surface, on the side of `normal`. It begins at
/// the light if something may lie close to that: an origin is known to its own error, a far end to one that
/// grows with the distance. What is as close to p would have kept the path from it.
template <uint32_t features>
CASTRAY_INLINE Segment to_trace(const LightList& lights, const LightSegment& light, const Vec& p,
                                const Vec& normal) {
  if (lights.may_be_covered) return {light.end, far_end<features>(p, normal, light.end) - light.end};
  return {p, far_end<features>(light.end, light.normal, p) - p};
}

}  // namespace castray::CASTRAY_ISA
