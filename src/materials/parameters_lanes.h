#pragma once

#include "core/contract.h"
#include "materials/kernel_material.h"
#include "simd/vec_lanes.h"

// The values of surfaces at points, as vertices and suffixes carry them: arrays to be copied blindly. Kernels
// without detail carry the colour in slot_kd alone; all else is the material's.

namespace castray::CASTRAY_ISA {

template <uint32_t features>
inline constexpr int carried_floats = (features & feature_detail) ? vertex_floats : 3;

/// The values of points, one in each lane.
template <uint32_t features>
struct Parameters {
  Float value[carried_floats<features>];

  CASTRAY_INLINE Vec kd() const { return vec(slot_kd); }
  CASTRAY_INLINE Vec vec(int slot) const { return {value[slot], value[slot + 1], value[slot + 2]}; }
};

/// The values of N points.
template <int N>
struct ParameterArray {
  alignas(64) float value[vertex_floats][N];
};

/// From entry i on.
template <uint32_t features, int N>
CASTRAY_INLINE Parameters<features> load(const ParameterArray<N>& from, int i) {
  Parameters<features> p;
  for (int k = 0; k < carried_floats<features>; ++k) p.value[k] = load(from.value[k] + i);
  return p;
}
template <int N>
CASTRAY_INLINE Vec load_vec(const ParameterArray<N>& from, int slot, int i) {
  return {load(from.value[slot] + i), load(from.value[slot + 1] + i), load(from.value[slot + 2] + i)};
}
template <int N>
CASTRAY_INLINE Vec load_kd(const ParameterArray<N>& from, int i) {
  return load_vec(from, slot_kd, i);
}
template <int N>
CASTRAY_INLINE void store_kd(ParameterArray<N>& to, int i, const Vec& kd) {
  store(to.value[slot_kd] + i, kd.x);
  store(to.value[slot_kd + 1] + i, kd.y);
  store(to.value[slot_kd + 2] + i, kd.z);
}

/// One entry in each lane.
template <uint32_t features, int N>
CASTRAY_INLINE Parameters<features> gather_entries(const ParameterArray<N>& from, Uint i) {
  Parameters<features> p;
  for (int k = 0; k < carried_floats<features>; ++k) p.value[k] = gather(from.value[k], i);
  return p;
}

/// One entry in all lanes.
template <uint32_t features, int N>
CASTRAY_INLINE Parameters<features> broadcast_entry(const ParameterArray<N>& from, int i) {
  Parameters<features> p;
  for (int k = 0; k < carried_floats<features>; ++k) p.value[k] = Float(from.value[k][i]);
  return p;
}

template <uint32_t features, int N>
CASTRAY_INLINE void compress_store(ParameterArray<N>& to, int n, Mask m, const Parameters<features>& p) {
  for (int k = 0; k < carried_floats<features>; ++k) compress_store(to.value[k] + n, m, p.value[k]);
}

/// Whether the material at offset `record` has all of the given traits.
CASTRAY_INLINE Mask has_traits(const MaterialTables& tables, Uint record, uint32_t traits) {
  return (gather(tables.materials, &KernelMaterial::traits, record) & traits) == Uint(traits);
}

/// What the material at offset `record` says itself.
template <uint32_t features>
CASTRAY_INLINE Parameters<features> gather_parameters(const MaterialTables& tables, Uint record) {
  Parameters<features> p;
  for (int k = 0; k < carried_floats<features>; ++k)
    p.value[k] = gather(fields_of(tables.materials, &KernelMaterial::value) + k, record);
  return p;
}

}  // namespace castray::CASTRAY_ISA
