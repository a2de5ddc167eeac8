#pragma once

#include "materials/bsdf_sample_lanes.h"

// materials/lobe_albedo.h in lanes, and what models with a tabulated lobe share.

namespace castray::CASTRAY_ISA {

CASTRAY_INLINE Vec schlick(Vec f0, Float cosine) {
  const Float m = min(max(Float(1.f) - cosine, Float(0.f)), Float(1.f)), m2 = m * m, m5 = m2 * m2 * m;
  return fma(f0, Float(1.f) - m5, Vec{m5, m5, m5});
}

CASTRAY_INLINE Vec one_minus(const Vec& v) { return {Float(1.f) - v.x, Float(1.f) - v.y, Float(1.f) - v.z}; }

/// What a lobe of reflectance f0, whose table is at offset `albedo`, leaves of light to or from a direction:
/// 1 - E.
CASTRAY_INLINE Vec left_by_lobe(const KernelAlbedo* albedos, Uint albedo, Vec f0, Float cosine) {
  const Uint i = to_uint(min(sqrt(cosine) * Float((float)albedo_intervals), Float(albedo_intervals - 1.f)));
  const Float step(1.f / albedo_intervals);
  const Float c0 = square(to_float(i) * step), c1 = square(to_float(i + 1u) * step);
  const Float t = (cosine - c0) / (c1 - c0);
  const Uint at = albedo + i;
  const Float a0 = gather(albedos, &KernelAlbedo::a, at), a1 = gather(albedos, &KernelAlbedo::a, at + 1u);
  const Float lost0 = gather(albedos, &KernelAlbedo::lost, at),
              lost1 = gather(albedos, &KernelAlbedo::lost, at + 1u);
  const Float lost = fma(t, lost1 - lost0, lost0);
  return fma(one_minus(f0), fma(t, a1 - a0, a0), Vec{lost, lost, lost});
}

/// The same of a lobe that reflects all: what facets lose to one another.
CASTRAY_INLINE Float lost_by_lobe(const KernelAlbedo* albedos, Uint albedo, Float cosine) {
  return left_by_lobe(albedos, albedo, Vec{Float(1.f), Float(1.f), Float(1.f)}, cosine).x;
}

/// scattered_again of lobe_albedo.h.
CASTRAY_INLINE Float scattered_again(Float mean_fresnel, Float mean_lost) {
  const Float again =
      square(mean_fresnel) * (Float(1.f) - mean_lost) / (Float(1.f) - mean_fresnel * mean_lost);
  return again / max(mean_lost, Float(least_left_for_base));
}

/// The albedo of a base of colour kd over what that lobe leaves for it on the mean; see lobe_albedo.h.
CASTRAY_INLINE Vec base_under(const KernelAlbedo* albedos, Uint albedo, Vec kd, Vec f0) {
  const Float a = gather(albedos, &KernelAlbedo::mean_a, albedo),
              lost = gather(albedos, &KernelAlbedo::mean_lost, albedo);
  const Vec left = fma(one_minus(f0), a, Vec{lost, lost, lost});
  const Float least(least_left_for_base);
  return {kd.x / max(left.x, least), kd.y / max(left.y, least), kd.z / max(left.z, least)};
}

/// Where an image gives alpha, makes it that of the nearest row of LobeAlbedoRows. Returns the row's table.
CASTRAY_INLINE Uint round_alpha_to_row(const KernelDetail& d, Float* value) {
  if (!(d.albedo_rows > 0)) return Uint(d.albedo);
  const Uint row = to_uint(fma(sqrt(value[slot_alpha]), Float(d.albedo_rows), Float(0.5f)));
  const Float roughness = to_float(row) * Float(1.f / albedo_row_steps);
  value[slot_alpha] = roughness * roughness;
  return Uint(d.albedo) + row * uint32_t{albedo_floats};
}

}  // namespace castray::CASTRAY_ISA
