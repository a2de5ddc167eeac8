#pragma once

#include "wavefront/scratch_lanes.h"

namespace castray::CASTRAY_ISA {

CASTRAY_INLINE bool clamps_indirect(const KernelOptions& options) {
  return options.most_indirect < __builtin_inff();
}

/// What the tile's light points and suffixes have brought to pixels i to i + width - 1.
template <uint32_t features>
CASTRAY_INLINE Vec reflected(const Scratch& s, int i) {
  const Vec sum = load(s.gathered.sum, i);
  return (features & feature_materials) ? sum : sum * load_kd(s.camera.parameters, i);
}

/// Keeps the radiance so far, and what is gathered so far, as the direct part of each sample.
CASTRAY_INLINE void keep_direct(const Context& c, Scratch& s) {
  if (!clamps_indirect(c.options)) return;
  for (int i = 0; i < c.job.tiles * tile_pixels; i += width) store(s.direct, i, load(s.radiance, i));
}

template <uint32_t features>
CASTRAY_INLINE void add_gathered_to_direct(const Context& c, Scratch& s) {
  if (!clamps_indirect(c.options)) return;
  for (int i = 0; i < c.job.tiles * tile_pixels; i += width)
    store(s.direct, i, load(s.direct, i) + reflected<features>(s, i));
}

/// Scales the rest of each sample down to the greatest component that it may have.
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
