#pragma once

#include "lights/area_lights_lanes.h"
#include "materials/kernel_material.h"

// What stages ask of lights, besides light from outside (lights/environment_lanes.h): sample a light, and
// weigh a light that a ray hit.

namespace castray::CASTRAY_ISA {

/// A light sample. `choice` and `deep` choose the light, u and v the point on it; see choose_light.
CASTRAY_INLINE LightPoint sample_light(const LightList& list, const Receiver& receiver, Float choice,
                                       Float deep, Float u, Float v) {
  return sample_area_light(list, choose_light(list, choice, deep, receiver), receiver, u, v);
}

/// A surface that a ray hit, as a light.
struct FoundLight {
  Mask shines;      ///< it emits to the side that the ray comes from
  Mask both_sides;  ///< and to the other
  Vec emission;     ///< of its material, before images
  Float density;    ///< area pdf of the point under light sampling, for MIS
};
CASTRAY_INLINE FoundLight found_light(const KernelMaterial* materials, Uint material, Mask front) {
  const Uint traits = gather(materials, &KernelMaterial::traits, material);
  const auto has = [&](uint32_t trait) { return ~((traits & trait) == Uint(0u)); };
  return {front | has(trait_emits_behind | trait_emits_backwards), has(trait_emits_behind),
          gather_vec(fields_of(materials, &KernelMaterial::value) + slot_emission, material),
          gather(materials, &KernelMaterial::light_density, material)};
}

}  // namespace castray::CASTRAY_ISA
