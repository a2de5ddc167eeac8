#pragma once

#include "geometry/ray_batches.h"
#include "materials/footprint_lanes.h"
#include "materials/parameters_lanes.h"
#include "simd/array_rows_lanes.h"
#include "simd/random_lanes.h"
#include "simd/vec_lanes.h"
#include "wavefront/kernel_api.h"

// A wave: arrays that flow through the stages, read and written a lane vector at a time. Entries from
// `count` to the next multiple of the width are garbage: stages may compute on them but never add them up.

namespace castray::CASTRAY_ISA {

inline constexpr int capacity = batch_size + 16;  ///< compressed stores write a full vector

using FloatArray = float[capacity];

using UintArray = uint32_t[capacity];

/// A path's output slot, random-number key and index, and next light sample.
struct PathNames {
  static constexpr int size = capacity;
  alignas(64) UintArray slot, key, index;
  alignas(64) FloatArray light_u, light_v;
};

CASTRAY_INLINE Sequence sequence_of(const PathNames& names, int i) {
  return {load(names.key + i), load(names.index + i)};
}

/// Paths::arrival of rays whose emission has MIS weight 1: light sampling cannot find it.
inline constexpr float counts_all = 0x1p126f;

/// Rays with the state of their paths. Directions are unit vectors, except the camera's.
struct Paths {
  int count = 0;
  VecArray<capacity> o, d, throughput;
  alignas(64) FloatArray arrival;  ///< pdf of the direction, for MIS, or counts_all; or 0: emission does not
                                   ///< count; negative: light paths bring that of lamps
  alignas(64) FloatArray eta2;     ///< product of eta^2 over refractions, for roulette
  alignas(64) UintArray media;     ///< see absorption_lanes.h; only where a material absorbs
  PathNames names;
};

/// PixelView of the camera rays' pixels; only where a map filters.
struct PixelViews {
  VecArray<capacity> o, d, o_right, d_right, o_down, d_down;
  alignas(64) FloatArray sample_x, sample_y;
};
CASTRAY_INLINE PixelView load(const PixelViews& views, int i) {
  return {load(views.o, i),      load(views.d, i),      load(views.o_right, i),   load(views.d_right, i),
          load(views.o_down, i), load(views.d_down, i), load(views.sample_x + i), load(views.sample_y + i)};
}
CASTRAY_INLINE void store(PixelViews& views, int i, const PixelView& view) {
  store(views.o, i, view.o);
  store(views.d, i, view.d);
  store(views.o_right, i, view.o_right);
  store(views.d_right, i, view.d_right);
  store(views.o_down, i, view.o_down);
  store(views.d_down, i, view.d_down);
  store(views.sample_x + i, view.sample_x);
  store(views.sample_y + i, view.sample_y);
}

/// Values of t_max: of rays, and of segments.
struct FarEnds {
  alignas(64) FloatArray infinite, one;

  CASTRAY_INLINE void fill() {
    for (int i = 0; i < capacity; ++i) {
      infinite[i] = __builtin_inff();
      one[i] = 1;
    }
  }
};

/// Closest hits: ray parameter, facet or triangle, and barycentrics of a triangle.
struct Hits {
  alignas(64) FloatArray t, b1, b2;
  alignas(64) UintArray primitive, instance;  ///< the latter is written by InstanceGeometry alone
};

inline constexpr uint32_t seen_from_front = 0x80000000u;

/// Path vertices. Arrays and nothing else, so that entries are copied as a whole. `normal` is the
/// geometric normal on wo's side; `p` is offset to that side by `error`, the bound of its distance from
/// the surface.
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
  alignas(64) UintArray media;         ///< those that the path arrived through, as in Paths
};
struct Vertices : VertexArrays {
  int count = 0;
};

/// The offset of its record, of VertexArrays::material.
CASTRAY_INLINE Uint record_of(Uint material) { return material & ~seen_from_front; }

/// Shadow rays: segments o + t d, 0 < t < 1, and the radiance each adds if unoccluded.
struct ShadowRays {
  int count = 0;
  VecArray<capacity> o, d, radiance;
  alignas(64) UintArray slot;
  alignas(64) FloatArray kept;  ///< as in ShadowBatch
  alignas(64) uint8_t blocked[capacity];
};

}  // namespace castray::CASTRAY_ISA
