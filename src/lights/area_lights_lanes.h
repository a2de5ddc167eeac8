#pragma once

#include "lights/light_choice_lanes.h"
#include "lights/light_point_lanes.h"
#include "lights/rectangle_lanes.h"
#include "materials/surface_values_lanes.h"

namespace castray::CASTRAY_ISA {

/// A KernelLight in each lane.
struct Light {
  Vec origin, edge1, edge2, normal, emission;
  Float area, error, density;
  Mask triangle, two_sided, rectangle;
  Uint material, source, node;
};
CASTRAY_INLINE Light broadcast(const KernelLight& l) {
  const auto flag = [](uint32_t v) { return Uint(v) == Uint(1u); };
  return {broadcast(l.origin),   broadcast(l.edge1), broadcast(l.edge2), broadcast(l.normal),
          broadcast(l.emission), Float(l.area),      Float(l.error),     Float(l.density),
          flag(l.triangle),      flag(l.two_sided),  flag(l.rectangle),  Uint(l.material),
          Uint(l.source),        Uint(l.node)};
}
CASTRAY_INLINE Light light_of(const LightList& list, Uint light) {
  if (list.count == 1) return broadcast(*list.lights);
  using L = KernelLight;
  const Uint record = light * uint32_t{light_floats};
  const auto vec = [&](float(L::*field)[3]) { return gather_vec(list.lights, field, record); };
  const auto number = [&](float L::*field) { return gather(list.lights, field, record); };
  const auto integer = [&](uint32_t L::*field) { return gather(list.lights, field, record); };
  const auto flag = [&](uint32_t L::*field) { return integer(field) == Uint(1u); };
  return {vec(&L::origin),     vec(&L::edge1),
          vec(&L::edge2),      vec(&L::normal),
          vec(&L::emission),   number(&L::area),
          number(&L::error),   number(&L::density),
          flag(&L::triangle),  flag(&L::two_sided),
          flag(&L::rectangle), integer(&L::material),
          integer(&L::source), list.regions.tree ? integer(&L::node) : Uint(0u)};
}

/// A point on the chosen light, uniform in area or, where asked for and possible, in solid angle.
CASTRAY_INLINE LightPoint sample_area_light(const LightList& list, const LightChoice& chosen,
                                            const Receiver& receiver, Float u, Float v) {
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
  Vec emission = light.emission;
  if (list.materials) {
    const Uint record = chosen.light * uint32_t{light_floats};
    const float* corner = fields_of(list.lights, &KernelLight::corner);
    const Float step = gather(list.lights, &KernelLight::step, record);
    const TrianglePlace place{light.source, fma(step, a, gather(corner, record)),
                              fma(step, b, gather(corner + 1, record))};
    resolve_emission(*list.materials, *list.triangles, light.material * uint32_t{material_floats}, place,
                     emission);
  }
  return {p,           light.normal, emission * inverse_density, light.density, light.two_sided, light.error,
          Mask(false), light.node};
}

}  // namespace castray::CASTRAY_ISA
