#pragma once

#include "wavefront/absorption_lanes.h"
#include "wavefront/context_lanes.h"
#include "wavefront/gatherers_lanes.h"
#include "wavefront/shading_lanes.h"

// How much light each pixel of a tile gets from a sender: a light point, the end of a suffix, or a direction
// from which light arrives from outside the scene.

namespace castray::CASTRAY_ISA {

/// A sender y, which emits to the side of its normal. `own`: the pixel that is known to see it, or -1.
/// `seen`: some pixel is known to.
struct Sender {
  Vec p, normal;
  int own;
  bool seen;
};

/// A sender at infinity, in direction w.
struct FarSender {
  Vec w;
  int own;
};

/// For each pixel: `weight`, f cos cos' V / |x - y|^2; and `density`, the pdf, per area at y, with which
/// BSDF sampling at x finds y. For a far sender f cos V and the pdf of the direction. With diffuse materials
/// only, `weight` is not stored: it is density times albedo.
struct Transfer {
  Float density[tile_vectors];
  Vec weight[tile_vectors];
};

/// Which of the points i to i + width - 1 of a tile reflect by other models than Lambert's, so that a
/// transfer by cosines needs to be replaced. `normal`: theirs.
template <uint32_t features>
CASTRAY_INLINE Mask by_bsdf(const Context& c, const Gatherers& tile, int entry, const Vec& normal) {
  if constexpr (features & feature_detail) return Mask(true);
  return has_traits(c.scene, record_of(load(tile.x.material + entry)), trait_directional) &
         (length_squared(normal) > Float(0.f));
}

/// Replaces vector i of a transfer, in `lanes`, by what the BSDF says about direction wi. `geometry` turns
/// densities of directions into those of the sender.
template <uint32_t features>
CASTRAY_INLINE void transfer_by_bsdf(Context& c, const Gatherers& tile, int i, Mask lanes, const Vec& wi,
                                     Float geometry, Transfer& t) {
  c.evaluated += (uint64_t)count(lanes);
  const int entry = tile.first + i * width;
  const Shading shading = shading_of<features>(c.scene, tile.x, entry);
  const Vec local = to_local(shading.frame, wi);
  const BsdfValue value = evaluate(shading.bsdf, shading.wo, local);
  const Mask valid = shading.consistent(wi, local) & (length_squared(shading.normal) > Float(0.f));
  t.density[i] = select(lanes, select(valid, value.pdf * geometry, Float(0.f)), t.density[i]);
  t.weight[i] = select(lanes, select(valid, value.f_cos * geometry, black()), t.weight[i]);
}

/// Transfer without visibility.
template <uint32_t features>
CASTRAY_INLINE void unoccluded_transfer(Context& c, const Sender& y, const Gatherers& tile, Transfer& t) {
  for (int i = 0; i < tile_vectors; ++i) {
    const int entry = tile.first + i * width;
    const Vec d = load(tile.x.p, entry) - y.p, normal = load(tile.x.normal, entry);
    const Float distance2 = max(length_squared(d), Float(0x1p-60f));
    const Float cos_y = max(dot(y.normal, d), Float(0.f)), cos_x = max(-dot(normal, d), Float(0.f));
    t.density[i] = cos_x * cos_y / (distance2 * distance2) * Float(1.f / pi);
    if constexpr (features & feature_materials) {
      t.weight[i] = load_kd(tile.x.parameters, entry) * t.density[i];
      const Mask lanes = by_bsdf<features>(c, tile, entry, normal);
      if (none(lanes)) continue;
      const Float inverse = Float(1.f) / sqrt(distance2);
      transfer_by_bsdf<features>(c, tile, i, lanes, d * -inverse, cos_y * inverse * inverse * inverse, t);
    }
  }
}

template <uint32_t features>
CASTRAY_INLINE void unoccluded_transfer(Context& c, const FarSender& y, const Gatherers& tile, Transfer& t) {
  for (int i = 0; i < tile_vectors; ++i) {
    const int entry = tile.first + i * width;
    const Vec normal = load(tile.x.normal, entry);
    t.density[i] = max(dot(normal, y.w), Float(0.f)) * Float(1.f / pi);
    if constexpr (features & feature_materials) {
      t.weight[i] = load_kd(tile.x.parameters, entry) * t.density[i];
      const Mask lanes = by_bsdf<features>(c, tile, entry, normal);
      if (any(lanes)) transfer_by_bsdf<features>(c, tile, i, lanes, y.w, Float(1.f), t);
    }
  }
}

/// Lengths of the segments between a sender and points.
CASTRAY_INLINE Float distance_to(const Sender& y, const Vec& p) { return sqrt(length_squared(p - y.p)); }
CASTRAY_INLINE Float distance_to(const FarSender&, const Vec&) { return Float(endless); }

/// Absorption between a sender and the pixels of a tile.
template <class AnySender>
CASTRAY_INLINE void dim(const Context& c, const AnySender& y, const Gatherers& tile, Transfer& t) {
  for (int i = 0; i < tile_vectors; ++i) {
    const int entry = tile.first + i * width;
    const Float distance = distance_to(y, load(tile.x.p, entry));
    t.weight[i] = t.weight[i] * transmittance(c.scene, load(tile.x.media + entry), distance);
  }
}

/// Radiance gathered by the pixels of a job; with diffuse materials only, irradiance over pi: not yet
/// times albedo.
struct Gathered {
  VecArray<batch_size> sum;
};

template <uint32_t features>
CASTRAY_INLINE void add_scaled(Gathered& gathered, int first, const Transfer& t, const Vec& radiance) {
  for (int i = 0; i < tile_vectors; ++i) {
    const Vec before = load(gathered.sum, first + i * width);
    const Vec more = (features & feature_materials) ? fma_vec(radiance, t.weight[i], before)
                                                    : fma(radiance, t.density[i], before);
    store(gathered.sum, first + i * width, more);
  }
}

}  // namespace castray::CASTRAY_ISA
