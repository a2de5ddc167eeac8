#pragma once

#include "simd/vec_lanes.h"
#include "wavefront/kernel_api.h"

namespace castray::CASTRAY_ISA {

/// Radiance sums by slot. Slots of pixels come first, then those of suffixes, then those of light points and
/// of samples of the environment at glossy suffixes.
struct Radiance {
  static constexpr int slots = 4 * batch_size;
  alignas(64) float x[slots], y[slots], z[slots];

  CASTRAY_INLINE void clear() { __builtin_memset(this, 0, sizeof *this); }
  CASTRAY_INLINE void clear_suffixes() {
    for (int slot = batch_size; slot < slots; ++slot) x[slot] = y[slot] = z[slot] = 0;
  }
  CASTRAY_INLINE Vec at(int slot) const { return {Float(x[slot]), Float(y[slot]), Float(z[slot])}; }

  /// Adds the lanes in `m`, in their order.
  CASTRAY_INLINE void add(const uint32_t* slot, Mask m, Vec v) {
    alignas(64) float r[width], g[width], b[width];
    store(r, v.x);
    store(g, v.y);
    store(b, v.z);
    for (uint32_t left = bits(m); left; left &= left - 1) {
      const int l = __builtin_ctz(left);
      x[slot[l]] += r[l];
      y[slot[l]] += g[l];
      z[slot[l]] += b[l];
    }
  }
};

/// Slots i to i + width - 1.
CASTRAY_INLINE Vec load(const Radiance& r, int i) { return {load(r.x + i), load(r.y + i), load(r.z + i)}; }

CASTRAY_INLINE void store(Radiance& r, int i, Vec v) {
  store(r.x + i, v.x);
  store(r.y + i, v.y);
  store(r.z + i, v.z);
}

}  // namespace castray::CASTRAY_ISA
