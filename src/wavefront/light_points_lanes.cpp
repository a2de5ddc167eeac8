#include "wavefront/light_points_lanes.h"

#include "lights/delta_lights_lanes.h"
#include "lights/environment_lanes.h"
#include "wavefront/sequence_keys_lanes.h"
#include "wavefront/shading_lanes.h"

namespace castray::CASTRAY_ISA {

LightPoint vertex_light_points(const Context& c, const Vertices& vertices, int i, uint32_t vertex,
                               bool opaque) {
  Numbers<4> n{{Float(0.f), Float(0.f), Float(0.f), Float(0.f)}};
  if (c.scene.lights.count > 1)
    n = draw<4>(c.options.sobol, sequence_of(vertices.names, i), PathBlocks::choice(vertex));
  Mask one_sided(true);
  if (!opaque) one_sided = ~has_traits(c.scene, record_of(load(vertices.material + i)), trait_transmits);
  const Receiver receiver =
      receiving_point(c.scene.lights.regions, load(vertices.p, i), load(vertices.normal, i), one_sided);
  return sample_light(c.scene.lights, receiver, n.u[2], n.u[3], load(vertices.names.light_u + i),
                      load(vertices.names.light_v + i));
}

LightPoint vertex_environment_points(const Context& c, const Vertices& vertices, int i, uint32_t vertex) {
  const Numbers<2> n =
      draw<2>(c.options.sobol, sequence_of(vertices.names, i), PathBlocks::environment(vertex));
  const EnvironmentSample sample = sample_environment(c.scene.lights.environment, n.u[0], n.u[1]);
  const Float density = sample.light.density;
  const Float inverse = select(density > Float(0.f), Float(1.f) / density, Float(0.f));
  return {sample.w,   -sample.w, sample.light.radiance * inverse, density, Mask(false), Float(0.f),
          Mask(true), Uint(0u)};
}

LightPoint vertex_delta_lights(const Context& c, const Vertices& vertices, int i, uint32_t vertex) {
  const DeltaList& lights = c.scene.lights.deltas;
  Numbers<3> n{{Float(0.f), Float(0.f), Float(0.f)}};
  if (lights.count > 1)
    n = draw<3>(c.options.sobol, sequence_of(vertices.names, i), PathBlocks::environment(vertex));
  const Mask one_sided = ~has_traits(c.scene, record_of(load(vertices.material + i)), trait_transmits);
  return sample_delta_light(lights, {load(vertices.p, i), load(vertices.normal, i), one_sided}, n.u[2]);
}

/// Sums over the tile's points what is seen from their regions.
CASTRAY_INLINE void look_around(const LightRegions& regions, const Gatherers& tile, TileLights& lights) {
  Float seen[most_light_cut / width];
  for (Float& s : seen) s = Float(0.f);
  for (int i = 0; i < tile_vectors; ++i) {
    const Vec normal = load(tile.x.normal, tile.first + i * width);
    const Uint row = row_at(regions, fma(normal, Float(light_front), load(tile.x.p, tile.first + i * width)));
    const Mask there = length_squared(normal) > Float(0.f);
    for (int l = 0; l < width; ++l) {
      if (!(bits(there) >> l & 1)) continue;
      for (int k = 0; k < most_light_cut / width; ++k)
        seen[k] = seen[k] + load(regions.seen + lane(row, l) + k * width);
    }
  }
  for (int k = 0; k < most_light_cut / width; ++k) store(lights.seen + k * width, seen[k]);
}

/// The pdf of the tile's light points over that of power-proportional ones.
CASTRAY_INLINE void find_density(const LightList& list, const Receiver& tile, TileLights& lights) {
  CutWeights weights;
  weigh_cut(list, tile, weights);
  const float sum = lane(weights.sum, 0), inverse = sum > 0 ? 1 / sum : 0;
  for (uint32_t i = 0; i < list.cut_count; ++i)
    lights.density[i] = lane(weights.of[i], 0) * inverse * list.regions.inverse_power[i];
}

Receiver receiver_of(const Context& c, const Gatherers& tile, TileLights& lights) {
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
  const LightList& list = c.scene.lights;
  const Receiver receiver{broadcast(tile.boxes.all.center),
                          mean,
                          Float(__builtin_sqrtf(half[0] * half[0] + half[1] * half[1] + half[2] * half[2])),
                          Float(cosine),
                          Float(__builtin_sqrtf(1 - cosine * cosine)),
                          (Float(0.5f) < Float(cosine)) & (length_squared(sum) > Float(0.f)),
                          list.regions.tree ? lights.seen : nullptr,
                          Uint(0u)};
  if (list.regions.tree) {
    look_around(list.regions, tile, lights);
    find_density(list, receiver, lights);
  }
  return receiver;
}

LightPoint tile_light_points(const Context& c, const Receiver& tile, const TileLights& lights,
                             const TileSequence& sequence, int first) {
  const auto points = (uint32_t)c.options.light_points;
  const Uint index = tile_index(sequence, Uint((uint32_t)first) + lane_index(), points);
  const Numbers<4> n = draw<4>(c.options.sobol, {Uint(sequence.key), index}, 0);
  const Mask second_half = Float(0.5f) <= n.u[3];
  const Float deep = fma(n.u[3], Float(2.f), select(second_half, Float(-1.f), Float(0.f)));
  LightPoint point = sample_light(c.scene.lights, tile, n.u[0], deep, n.u[1], n.u[2]);
  const Mask back = point.two_sided & ~second_half;
  const Float sides = select(point.two_sided, Float(2.f), Float(1.f));
  point.normal = select(back, -point.normal, point.normal);
  point.weight = point.weight * (sides * Float(1.f / (float)points));
  point.density = point.density * Float((float)points) / sides;
  if (c.scene.lights.regions.tree) point.density = point.density * gather(lights.density, point.node);
  point.p = fma(point.normal, point.error, point.p);
  return point;
}

}  // namespace castray::CASTRAY_ISA
