#pragma once

#include <stdint.h>

// What kernels trace: plain data, the same for every instruction set.

namespace castray {

inline constexpr uint32_t no_hit = 0xffffffffu;

/// Rays origin + t * direction, 0 < t < t_max, and what they hit: triangles of a tree, facets of a list.
struct RayBatch {
  const float *ox, *oy, *oz, *dx, *dy, *dz, *t_max;
  float* t;            ///< of the nearest hit, infinity if there is none
  uint32_t* triangle;  ///< `no_hit` if there is none; of equally near ones the lowest
  float *b1, *b2;      ///< a triangle's hit is at (1-b1-b2) v0 + b1 v1 + b2 v2; 0 for a facet
  uint32_t count;
  uint32_t* instance = nullptr;  ///< of an InstanceTree; others do not write it
};

/// Rays of which only whether they hit anything is asked.
struct ShadowBatch {
  const float *ox, *oy, *oz, *dx, *dy, *dz, *t_max;
  uint8_t* occluded;  ///< 1 or 0
  uint32_t count;
};

}  // namespace castray
