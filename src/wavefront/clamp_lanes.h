#pragma once

#include "wavefront/scratch_lanes.h"
#include "wavefront/tint_lanes.h"

namespace castray::CASTRAY_ISA {

CASTRAY_INLINE bool clamps_indirect(const KernelOptions& options) {
  return options.most_indirect < __builtin_inff();
}

/// Radiance that pixels i to i + width - 1 have gathered from the light points and suffixes of their
/// tile, as far as windows before the camera leave it.
template <uint32_t features>
CASTRAY_INLINE Vec reflected(const Context& c, const Scratch& s, int i) {
  const Vec sum = load(s.gathered.sum, i);
  if ((features & feature_materials) && has_tints(c)) return sum * load(s.camera.throughput, i);
  return (features & feature_materials) ? sum : sum * load_kd(s.camera.parameters, i);
}

/// Record the direct part of each sample: its radiance up to here, and what it has gathered up to here.
CASTRAY_INLINE void keep_direct(const Context& c, Scratch& s) {
  if (!clamps_indirect(c.options)) return;
  for (int i = 0; i < c.job.tiles * tile_pixels; i += width) store(s.direct, i, load(s.radiance, i));
}

template <uint32_t features>
CASTRAY_INLINE void add_gathered_to_direct(const Context& c, Scratch& s) {
  if (!clamps_indirect(c.options)) return;
  for (int i = 0; i < c.job.tiles * tile_pixels; i += width)
    store(s.direct, i, load(s.direct, i) + reflected<features>(c, s, i));
}

/// The same for shadow rays of what the camera sees, which have been traced.
CASTRAY_INLINE void add_unblocked_to_direct(const Context& c, Scratch& s) {
  if (!clamps_indirect(c.options)) return;
  const ShadowRays& rays = s.shadow_rays;
  for (int i = 0; i < rays.count; ++i) {
    if (rays.blocked[i]) continue;
    const uint32_t slot = rays.slot[i];
    s.direct.x[slot] += rays.radiance.x[i];
    s.direct.y[slot] += rays.radiance.y[i];
    s.direct.z[slot] += rays.radiance.z[i];
  }
}

/// Scales the indirect part of each sample down until no component exceeds most_indirect.
CASTRAY_INLINE void clamp_indirect(const Context& c, Scratch& s) {
  if (!clamps_indirect(c.options)) return;
  const Float most(c.options.most_indirect);
  for (int i = 0; i < c.job.tiles * tile_pixels; i += width) {
    const Vec whole = load(s.radiance, i), direct = load(s.direct, i), indirect = whole - direct;
    const Float brightest = max_component(indirect);
    store(s.radiance, i, select(brightest > most, fma(indirect, most / brightest, direct), whole));
  }
}

}  // namespace castray::CASTRAY_ISA
