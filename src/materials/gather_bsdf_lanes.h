#pragma once

#include "materials/bsdf_lanes.h"
#include "materials/parameters_lanes.h"

namespace castray::CASTRAY_ISA {

/// How lobes lie that are not round.
template <uint32_t features>
CASTRAY_INLINE void gather_stretch(const MaterialTables& tables, const Parameters<features>& p, Bsdf& b) {
  const Mask stretched = has_traits(tables, b.record, trait_stretched);
  const Mask metal = b.is(MaterialType::conductor);
  for (int k = 0; k < 2; ++k)
    b.stretch[k] = select(
        stretched, select(metal, p.value[slot_stretch + k], p.value[slot_layered_stretch + k]), Float(0.f));
}

/// The BSDF of each lane. `material`: the offset of its record, with the top bit where it is seen from the
/// front.
template <uint32_t features>
CASTRAY_INLINE Bsdf gather_bsdf(const MaterialTables& tables, Uint material, const Parameters<features>& p) {
  const KernelMaterial* table = tables.materials;
  const Uint record = material & 0x7fffffffu;
  const Mask front = (material >> 31) == Uint(1u);
  const Float ior = gather(table, &KernelMaterial::ior, record);
  Bsdf b;
  b.type = gather(table, &KernelMaterial::type, record);
  b.kd = p.kd();
  b.eta = select(front | (ior < Float(0.f)), ior, Float(1.f) / ior);
  b.albedo = gather(table, &KernelMaterial::albedo, record);
  b.albedos = tables.albedos;
  b.record = record;
  b.materials = table;
  b.indices = tables.indices;
  b.stretched = false;
  b.scatters_again = tables.scatters_again;
  if constexpr (features & feature_detail) {
    b.ks = p.vec(slot_ks);
    b.alpha = p.value[slot_alpha];
    const Uint row =
        to_uint(fma(sqrt(b.alpha), gather(table, &KernelMaterial::albedo_rows, record), Float(0.5f)));
    b.albedo = b.albedo + row * uint32_t{albedo_floats};
    b.own[0] = p.value[slot_metal_sheen];
    b.own[1] = p.value[slot_coat];
    b.stretched = tables.stretched;
    if (b.stretched) gather_stretch(tables, p, b);
  } else {
    const float* values = fields_of(table, &KernelMaterial::value);
    b.ks = gather_vec(values + slot_ks, record);
    b.alpha = gather(values + slot_alpha, record);
    if (any(b.is(MaterialType::principled))) {
      b.own[0] = gather(values + slot_metal_sheen, record);
      b.own[1] = gather(values + slot_coat, record);
    }
  }
  return b;
}

}  // namespace castray::CASTRAY_ISA
