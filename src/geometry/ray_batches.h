#pragma once

#include <stdint.h>

// What kernels trace: plain data, the same for every instruction set.

namespace castray {

inline constexpr uint32_t no_hit = 0xffffffffu;

/// The random sequences, one for each ray, whose numbers decide what of partial triangles is there for it.
struct PresenceNumbers {
  const uint32_t *key = nullptr, *index = nullptr;
  bool sobol = false;
};

/// Rays origin + t * direction, 0 < t < t_max, and what they hit: triangles of a tree, facets of a list.
struct RayBatch {
  const float *ox, *oy, *oz, *dx, *dy, *dz, *t_max;
  float* t;            ///< of the nearest hit, infinity if there is none
  uint32_t* triangle;  ///< `no_hit` if there is none; of equally near ones the lowest
  float *b1, *b2;      ///< a triangle's hit is at (1-b1-b2) v0 + b1 v1 + b2 v2; 0 for a facet
  uint32_t count;
  uint32_t* instance = nullptr;  ///< of an InstanceTree; others do not write it
  PresenceNumbers presence{};    ///< null: what of partial triangles is there is that of the world
};

/// Rays of which only whether they hit anything is asked.
struct ShadowBatch {
  const float *ox, *oy, *oz, *dx, *dy, *dz, *t_max;
  uint8_t* occluded;  ///< 1 or 0
  uint32_t count;
  float* kept = nullptr;  ///< the share of light that partial triangles leave, for rays that are not
                          ///< occluded; null: they occlude where they are there in the world
};

/// Rays of which is asked what the windows that they pass leave of colours (PartialTriangles::tint).
struct TintBatch {
  const float *ox, *oy, *oz, *dx, *dy, *dz, *t_max;
  uint8_t* room;  ///< for a byte each
  uint32_t count;
  float *red, *green, *blue;                               ///< multiplied
  const uint32_t *end = nullptr, *end_instance = nullptr;  ///< the triangles on which they end; or null
};

}  // namespace castray
