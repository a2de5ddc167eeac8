#pragma once

#include "materials/bsdf_lanes.h"
#include "materials/footprint_lanes.h"
#include "materials/parameters_lanes.h"

// The one place where images become values: between a hit and its vertex.

namespace castray::CASTRAY_ISA {

/// What maps read at points of triangles: texture coordinates and the vertices' colours, where there are any.
struct MapInputs {
  Float u, v;
  Vec color;
  Mask has_uv, has_color;
};

CASTRAY_INLINE MapInputs map_inputs(const TriangleTable& table, const TrianglePlace& at) {
  MapInputs in{Float(0.f), Float(0.f), black(), Mask(false), Mask(false)};
  if (table.uv_corners) {
    const Corners corners = corners_of(table.uv_corners, at.triangle);
    in.has_uv = ~(corners.a == Uint(no_corner));
    in.u = at.interpolate(table.uvs, corners, in.has_uv, 2, 0);
    in.v = at.interpolate(table.uvs, corners, in.has_uv, 2, 1);
  }
  if (table.color_corners) {
    const Corners corners = corners_of(table.color_corners, at.triangle);
    in.has_color = ~(corners.a == Uint(no_corner));
    in.color = {at.interpolate(table.colors, corners, in.has_color, 3, 0),
                at.interpolate(table.colors, corners, in.has_color, 3, 1),
                at.interpolate(table.colors, corners, in.has_color, 3, 2)};
  }
  return in;
}

/// Multiplies `value`, by ParameterSlot, by what those maps of a material say whose slots are in `wanted`.
/// `seen`: what the pixels see, or null.
CASTRAY_INLINE void apply_maps(const KernelDetail& d, uint32_t wanted, const MapInputs& in, Mask here,
                               const Footprint* seen, Float* value) {
  for (uint32_t i = 0; i < d.count; ++i) {
    const KernelMap& map = d.maps[i];
    const Mask valid = here & (map.is_colors ? in.has_color : in.has_uv);
    if (!(wanted >> map.slot & 1) || none(valid)) continue;
    const Vec factor = map.is_colors          ? in.color
                       : map.by_pixel && seen ? footprint_value(map, in.u, in.v, *seen, valid)
                                              : map_value(map, in.u, in.v);
    Float* slot = value + map.slot;
    if (map.count == 3) {
      slot[0] = select(valid, slot[0] * factor.x, slot[0]);
      slot[1] = select(valid, slot[1] * factor.y, slot[1]);
      slot[2] = select(valid, slot[2] * factor.z, slot[2]);
    } else {
      const Float once = slot[0] * factor.x, power = map.squared ? once * factor.x : once;
      slot[0] = select(valid, min(max(power, Float(0.f)), Float(1.f)), slot[0]);
    }
  }
}

/// Calls `work` for each material with details of the lanes in `active`, with the lanes that have it.
template <class Work>
CASTRAY_INLINE void for_each_detail(const MaterialTables& tables, Uint material, Mask active, Work work) {
  const Uint details = gather(tables.materials, &KernelMaterial::detail, material);
  for (uint32_t left = bits(active & ~(details == Uint(0u))); left;) {
    const uint32_t detail = lane(details, __builtin_ctz(left));
    const Mask here = details == Uint(detail);
    left &= ~bits(here);
    work(tables.details[detail - 1], here);
  }
}

/// How far from round a lobe of this anisotropy is; see slot_stretch.
CASTRAY_INLINE Float stretch_of(Float anisotropy) {
  const Float a = min(anisotropy, Float(most_anisotropy));
  return Float(0.5f) * a / sqrt(Float(1.f) - a);
}

/// Replaces a material's own values, the vertex_floats from `value` on, by those of the points in its lanes;
/// where its maps filter, by the means over what the pixels see, `seen`, unless that is null.
inline __attribute__((noinline)) void resolve_values(const MaterialTables& tables,
                                                     const TriangleTable& triangles, const Uint& material,
                                                     const TrianglePlace& at, const Footprint* seen,
                                                     Float* value) {
  if (none(~(gather(tables.materials, &KernelMaterial::detail, material) == Uint(0u)))) return;
  const MapInputs in = map_inputs(triangles, at);
  for_each_detail(tables, material, Mask(true), [&](const KernelDetail& d, Mask here) {
    Float own[parameter_floats];
    for (int k = 0; k < parameter_floats; ++k) own[k] = Float(d.value[k]);
    apply_maps(d, ~0u, in, here, seen, own);
    own[slot_alpha] = max(own[slot_alpha], Float(d.least_alpha));
    finish_values(all_models, d, tables.albedos, own);
    if (d.stretch_slot) own[d.stretch_slot] = stretch_of(own[slot_anisotropy]);
    for (int k = 0; k < vertex_floats; ++k) value[k] = select(here, own[k], value[k]);
  });
}

/// What is emitted at points of materials of which an image may say it, times the share that is there.
inline __attribute__((noinline)) void resolve_emission(const MaterialTables& tables,
                                                       const TriangleTable& triangles, const Uint& material,
                                                       const TrianglePlace& at, Vec& emission) {
  const MapInputs in = map_inputs(triangles, at);
  for_each_detail(tables, material, Mask(true), [&](const KernelDetail& d, Mask here) {
    Float own[parameter_floats];
    for (int k = 0; k < 3; ++k) own[slot_emission + k] = Float(d.value[slot_emission + k]);
    own[slot_coverage] = Float(d.value[slot_coverage]);
    apply_maps(d, 1u << slot_emission | 1u << slot_coverage, in, here, nullptr, own);
    const Vec whole{own[slot_emission], own[slot_emission + 1], own[slot_emission + 2]};
    emission = select(here, whole * own[slot_coverage], emission);
  });
}

}  // namespace castray::CASTRAY_ISA
