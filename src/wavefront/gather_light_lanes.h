#pragma once

#include "lights/light_share_lanes.h"
#include "wavefront/light_points_lanes.h"
#include "wavefront/sequence_keys_lanes.h"
#include "wavefront/suffixes_lanes.h"
#include "wavefront/visibility_lanes.h"

namespace castray::CASTRAY_ISA {

template <int N>
CASTRAY_INLINE Vec broadcast_entry(const VecArray<N>& a, int i) {
  return {Float(a.x[i]), Float(a.y[i]), Float(a.z[i])};
}

CASTRAY_INLINE Vec broadcast_lane(const Vec& v, int l) {
  return {Float(lane(v.x, l)), Float(lane(v.y, l)), Float(lane(v.z, l))};
}

/// A bit for each of the `count` light points from `first` on: one pixel, tried by a ray, sees it. Which one
/// does not depend on how many points are tried at once.
template <class Geometry>
CASTRAY_INLINE uint32_t seen_points(Context& c, const Gatherers& tile, const LightPoint& point, int first,
                                    int count, VisibilityScratch& s) {
  const Geometry geometry = geometry_of<Geometry>(c);
  const Uint number = Uint((uint32_t)first) + lane_index();
  const Uint pixel = Uint((uint32_t)tile.first) + (number * Uint(tile_pixels / 16) & Uint(tile_pixels - 1));
  const Vec p = gather_entries(tile.x.p, pixel), normal = gather_entries(tile.x.normal, pixel);
  store(s.o, 0, point.p);
  store(s.d, 0, geometry.far_end(p, normal, point.p) - point.p);
  geometry.occluded({s.o.x, s.o.y, s.o.z, s.d.x, s.d.y, s.d.z, c.ends.one, s.blocked, (uint32_t)count});
  c.asked += (uint64_t)count;
  uint32_t seen = 0;
  for (int l = 0; l < count; ++l) seen |= (s.blocked[l] ? 0u : 1u) << l;
  return seen & bits(length_squared(normal) > Float(0.f));
}

/// Every pixel of a tile gathers from every light point of the tile.
template <class Geometry, uint32_t features>
CASTRAY_STAGE void gather_light(Context& c, const Vertices& x, const TileBoxes* boxes,
                                const Suffixes& suffixes, TileLights* lights, VisibilityScratch& s,
                                Gathered& gathered) {
  if (c.scene.lights.count == 0) return;
  const int points = c.options.light_points;
  for (int tile = 0; tile < c.job.tiles; ++tile) {
    if ((features & feature_materials) && boxes[tile].empty) continue;
    Gatherers gatherers{x, tile * tile_pixels, boxes[tile]};
    const TileSequence sequence = tile_sequence(c, tile);
    const Origins& origins = suffixes.origins[tile];
    const float stratum = stratum_of(c, origins);
    const Receiver receiver = receiver_of(c, gatherers, lights[tile]);
    for (int first = 0; first < points; first += width) {
      const LightPoint point = tile_light_points(c, receiver, lights[tile], sequence, first);
      const int count = points - first < width ? points - first : width;
      const uint32_t seen =
          gatherers.boxes.facing != 0 ? seen_points<Geometry>(c, gatherers, point, first, count, s) : 0;
      for (int l = 0; l < count; ++l) {
        Transfer t;
        transfer<Geometry, features>(
            c, Sender{broadcast_lane(point.p, l), broadcast_lane(point.normal, l), -1, (seen >> l & 1) != 0},
            gatherers, s, t);
        const float density = lane(point.density, l);
        Vec radiance = broadcast_lane(point.weight, l);
        if (c.options.mis)
          radiance = radiance * light_share(Float(density), Float(found_from(origins, t.density) / stratum));
        add_scaled<features>(gathered, gatherers.first, t, radiance);
      }
    }
  }
}

}  // namespace castray::CASTRAY_ISA
