#pragma once

#include "lights/area_lights_lanes.h"
#include "wavefront/sequence_keys_lanes.h"
#include "wavefront/visibility_lanes.h"

namespace castray::CASTRAY_ISA {

/// The pixels of a tile that one suffix stands for.
CASTRAY_INLINE float stratum_of(const KernelOptions& options) {
  return (float)(tile_pixels / options.suffixes);
}

CASTRAY_INLINE Vec broadcast_lane(const Vec& v, int l) {
  return {Float(lane(v.x, l)), Float(lane(v.y, l)), Float(lane(v.z, l))};
}

/// The points of a tile, none of which lets light through, as one receiver.
CASTRAY_INLINE Receiver receiver_of(const Gatherers& tile) {
  Float x[tile_vectors], y[tile_vectors], z[tile_vectors];
  for (int i = 0; i < tile_vectors; ++i) {
    const Vec normal = load(tile.x.normal, tile.first + i * width);
    x[i] = normal.x;
    y[i] = normal.y;
    z[i] = normal.z;
  }
  const Float one(1.f);
  const Vec sum{Float(ordered_sum(x)), Float(ordered_sum(y)), Float(ordered_sum(z))}, mean = normalize(sum);
  Float least = one;
  for (int i = 0; i < tile_vectors; ++i) {
    const Vec normal = load(tile.x.normal, tile.first + i * width);
    least = min(least, select(length_squared(normal) > Float(0.f), dot(mean, normal), one));
  }
  float cosine = 1;
  for (int l = 0; l < width; ++l) cosine = lane(least, l) < cosine ? lane(least, l) : cosine;
  cosine -= 0x1p-12f;
  const float* half = tile.boxes.all.half;
  return {broadcast(tile.boxes.all.center),
          mean,
          Float(__builtin_sqrtf(half[0] * half[0] + half[1] * half[1] + half[2] * half[2])),
          Float(cosine),
          Float(__builtin_sqrtf(1 - cosine * cosine)),
          (Float(0.5f) < Float(cosine)) & (length_squared(sum) > Float(0.f))};
}

/// The light points of one tile, `count` <= width of them at once.
CASTRAY_INLINE LightPoint tile_light_points(const Context& c, const Receiver& tile, uint32_t key, int first) {
  const auto points = (uint32_t)c.options.light_points;
  const Uint index = tile_index(key, c.job.sample, Uint((uint32_t)first) + lane_index(), points);
  const Numbers<4> n = draw<4>(c.options.sobol, {Uint(key), index}, 0);
  const Mask second_half = Float(0.5f) <= n.u[3];
  const Float deep = fma(n.u[3], Float(2.f), select(second_half, Float(-1.f), Float(0.f)));
  LightPoint point = sample_light(c.scene.lights, tile, n.u[0], deep, n.u[1], n.u[2]);
  const Mask back = point.two_sided & ~second_half;
  const Float sides = select(point.two_sided, Float(2.f), Float(1.f));
  point.normal = select(back, -point.normal, point.normal);
  point.weight = point.weight * (sides * Float(1.f / (float)points));
  point.density = point.density * Float((float)points) / sides;
  point.p = fma(point.normal, point.error, point.p);
  return point;
}

/// Light points shared by each tile.
template <uint32_t features>
CASTRAY_INLINE void gather_light(Context& c, const Vertices& x, const TileBoxes* boxes, const FarEnds& ends,
                                 VisibilityScratch& s, Gathered& gathered) {
  if (c.scene.lights.count == 0) return;
  const int points = c.options.light_points;
  for (int tile = 0; tile < c.job.tiles; ++tile) {
    Gatherers gatherers{x, tile * tile_pixels, boxes[tile]};
    const uint32_t key = tile_key(c, tile);
    const Receiver receiver = receiver_of(gatherers);
    for (int first = 0; first < points; first += width) {
      const LightPoint point = tile_light_points(c, receiver, key, first);
      for (int l = 0; l < width && first + l < points; ++l) {
        Transfer t;
        transfer<features>(c, {broadcast_lane(point.p, l), broadcast_lane(point.normal, l), -1}, gatherers,
                           ends, s, t);
        const float density = lane(point.density, l);
        const float share =
            c.options.mis ? density / (density + ordered_sum(t.density) / stratum_of(c.options)) : 1.f;
        add_scaled<features>(gathered, gatherers.first, t, broadcast_lane(point.weight, l) * Float(share));
      }
    }
  }
}

}  // namespace castray::CASTRAY_ISA
