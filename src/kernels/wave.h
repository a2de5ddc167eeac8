#pragma once

#include "kernels/api.h"
#include "kernels/random.h"
#include "kernels/vec.h"

// The arrays that flow through the stages of a batch. All are read and written a lane vector at a time;
// entries past `count` up to the next multiple of the width are garbage that every stage may compute on and
// none may add up.

namespace castray::CASTRAY_ISA {

inline constexpr int capacity = batch_size + 16;  ///< compressed stores write a full vector

template <int N>
CASTRAY_INLINE Sequence load_sequence(const uint32_t (&key)[N], const uint32_t (&index)[N], int i) {
  return {load(key + i), load(index + i)};
}

/// Rays under way and what they carry.
struct Paths {
  int count = 0;
  VecArray<capacity> o, d, throughput;
  alignas(64) float light_u[capacity],
      light_v[capacity];                ///< numbers that place the light point of the next vertex
  alignas(64) uint32_t slot[capacity];  ///< where their radiance is added
  alignas(64) uint32_t key[capacity], index[capacity];
};

/// What closest-hit search found for each path: distance and facet or triangle.
struct Hits {
  alignas(64) float t[capacity];
  alignas(64) uint32_t primitive[capacity];
};

/// Points on surfaces, ready to be lit and to scatter. `normal` is on the side of the arriving ray; `p` is
/// already moved to that side by the point's error bound.
struct Vertices {
  int count = 0;
  VecArray<capacity> p, normal, albedo, throughput;
  alignas(64) float light_u[capacity], light_v[capacity];
  alignas(64) uint32_t slot[capacity];
  alignas(64) uint32_t key[capacity], index[capacity];
};

/// Segments o + t d, 0 < t < 1, and the radiance that arrives if nothing is between.
struct ShadowRays {
  int count = 0;
  VecArray<capacity> o, d, radiance;
  alignas(64) uint32_t slot[capacity];
};

/// Sums of radiance; slots are those of paths: first the pixels, then the shared suffixes.
struct Radiance {
  alignas(64) float x[2 * batch_size], y[2 * batch_size], z[2 * batch_size];

  /// Adds in the lanes of `m`; no two of them have the same slot.
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

}  // namespace castray::CASTRAY_ISA
