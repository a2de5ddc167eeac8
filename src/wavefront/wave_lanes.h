#pragma once

#include "materials/parameters_lanes.h"
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

/// Who a path is: where its radiance is added, which random numbers it draws, and where on a light its next
/// vertex looks.
struct PathNames {
  alignas(64) UintArray slot, key, index;
  alignas(64) FloatArray light_u, light_v;
};

CASTRAY_INLINE Sequence sequence_of(const PathNames& names, int i) {
  return {load(names.key + i), load(names.index + i)};
}

/// Copies the names of entries i to i + width - 1 of `from`, those of `m`, to the entries of `to` from n on.
CASTRAY_INLINE void compress_names(PathNames& to, int n, Mask m, const PathNames& from, int i) {
  compress_store(to.slot + n, m, load(from.slot + i));
  compress_store(to.key + n, m, load(from.key + i));
  compress_store(to.index + n, m, load(from.index + i));
  compress_store(to.light_u + n, m, load(from.light_u + i));
  compress_store(to.light_v + n, m, load(from.light_v + i));
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

/// What closest-hit search found for each path: distance, facet or triangle, and barycentrics of the latter.
struct Hits {
  alignas(64) FloatArray t, b1, b2;
  alignas(64) UintArray primitive;
};

/// Points on surfaces, ready to be lit and to scatter. `normal` is the geometric one on the side of the
/// arriving ray; `p` is already moved to that side by `error`, the bound of its distance from the surface.
struct Vertices {
  int count = 0;
  VecArray<capacity> p, normal, throughput;
  ParameterArray<capacity> parameters;
  alignas(64) UintArray material;  ///< offset of its record, in floats; the top bit: seen from the front
  PathNames names;
  // Only where there are other materials than diffuse ones:
  VecArray<capacity> wo, shading_normal;
  alignas(64) FloatArray error, eta2;
};

/// Copies the vertices i to i + width - 1 of `from`, those of `m`, to the entries of `to` from n on.
template <uint32_t features>
CASTRAY_INLINE void compress_vertices(Vertices& to, int n, Mask m, const Vertices& from, int i) {
  compress_store(to.p, n, m, load(from.p, i));
  compress_store(to.normal, n, m, load(from.normal, i));
  compress_store(to.parameters, n, m, load<features>(from.parameters, i));
  compress_store(to.throughput, n, m, load(from.throughput, i));
  compress_store(to.material + n, m, load(from.material + i));
  compress_names(to.names, n, m, from.names, i);
  compress_store(to.wo, n, m, load(from.wo, i));
  compress_store(to.shading_normal, n, m, load(from.shading_normal, i));
  compress_store(to.error + n, m, load(from.error + i));
  compress_store(to.eta2 + n, m, load(from.eta2 + i));
}

/// Segments o + t d, 0 < t < 1, and the radiance that arrives if nothing is between.
struct ShadowRays {
  int count = 0;
  VecArray<capacity> o, d, radiance;
  alignas(64) UintArray slot;
  alignas(64) uint8_t blocked[capacity];
};

}  // namespace castray::CASTRAY_ISA
