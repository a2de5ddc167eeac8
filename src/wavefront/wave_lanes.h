#pragma once

#include "geometry/ray_batches.h"
#include "materials/parameters_lanes.h"
#include "simd/array_rows_lanes.h"
#include "simd/random_lanes.h"
#include "simd/vec_lanes.h"
#include "wavefront/kernel_api.h"

// The arrays that flow through the stages of a batch. All are read and written a lane vector at a time;
// entries past `count` up to the next multiple of the width are garbage that every stage may compute on and
// none may add up.

namespace castray::CASTRAY_ISA {

inline constexpr int capacity = batch_size + 16;  ///< compressed stores write a full vector

using FloatArray = float[capacity];

using UintArray = uint32_t[capacity];

/// Of each path: the slot its radiance is added to, its random numbers' key and index, and where on a light
/// the light point of its next vertex lies.
struct PathNames {
  static constexpr int size = capacity;
  alignas(64) UintArray slot, key, index;
  alignas(64) FloatArray light_u, light_v;
};

CASTRAY_INLINE Sequence sequence_of(const PathNames& names, int i) {
  return {load(names.key + i), load(names.index + i)};
}

/// How much of the emission that a ray finds it counts: all; or, where light sampling looks for it too, the
/// share that goes with the density of the ray's direction; 0 counts nothing.
inline constexpr float counts_all = 0x1p126f;

/// Rays under way, directions of unit length but the camera's, and what they carry.
struct Paths {
  int count = 0;
  VecArray<capacity> o, d, throughput;
  alignas(64) FloatArray arrival;  ///< density of the direction, or counts_all, or 0
  alignas(64) FloatArray eta2;     ///< what refraction has scaled the throughput by, inverted
  PathNames names;
};

/// Greatest ray parameters: of rays, and of segments.
struct FarEnds {
  alignas(64) FloatArray infinite, one;

  CASTRAY_INLINE void fill() {
    for (int i = 0; i < capacity; ++i) {
      infinite[i] = __builtin_inff();
      one[i] = 1;
    }
  }
};

/// What closest-hit search found for each path: distance, facet or triangle, and barycentrics of the latter.
struct Hits {
  alignas(64) FloatArray t, b1, b2;
  alignas(64) UintArray primitive;
};

inline constexpr uint32_t seen_from_front = 0x80000000u;

/// Path vertices, ready to be lit and to scatter: arrays alone, so that entries are copied as a whole.
/// `normal` is the geometric one, on wo's side, where `p` is offset to by `error`, the bound of its distance
/// from the surface.
struct VertexArrays {
  static constexpr int size = capacity;
  VecArray<capacity> p, normal, throughput;
  ParameterArray<capacity> parameters;
  alignas(
      64) UintArray material;  ///< offset of its record, in floats; and seen_from_front: wo is on that side
  PathNames names;
  // Only where there are other materials than diffuse ones:
  VecArray<capacity> wo, shading_normal;
  alignas(64) FloatArray error, eta2;  ///< eta2 as in Paths
};
struct Vertices : VertexArrays {
  int count = 0;
};

/// The offset of its record, of VertexArrays::material.
CASTRAY_INLINE Uint record_of(Uint material) { return material & ~seen_from_front; }

/// Segments o + t d, 0 < t < 1, and the radiance that arrives if nothing is between.
struct ShadowRays {
  int count = 0;
  VecArray<capacity> o, d, radiance;
  alignas(64) UintArray slot;
  alignas(64) uint8_t blocked[capacity];
};

}  // namespace castray::CASTRAY_ISA
