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
    const float stratum = stratum_of(c, suffixes.origins[tile]);
    const Receiver receiver = receiver_of(c, gatherers, lights[tile]);
    for (int first = 0; first < points; first += width) {
      const LightPoint point = tile_light_points(c, receiver, lights[tile], sequence, first);
      for (int l = 0; l < width && first + l < points; ++l) {
        Transfer t;
        transfer<Geometry, features>(
            c, Sender{broadcast_lane(point.p, l), broadcast_lane(point.normal, l), -1}, gatherers, s, t);
        const float density = lane(point.density, l);
        Vec radiance = broadcast_lane(point.weight, l);
        if (c.options.mis)
          radiance = radiance * light_share(Float(density), Float(ordered_sum(t.density) / stratum));
        add_scaled<features>(gathered, gatherers.first, t, radiance);
      }
    }
  }
}

}  // namespace castray::CASTRAY_ISA
