#pragma once

#include "lights/lights_lanes.h"
#include "wavefront/gather_light_lanes.h"
#include "wavefront/suffixes_lanes.h"

namespace castray::CASTRAY_ISA {

/// Every pixel of a tile gathers what arrives from outside along the suffixes of the tile that escaped.
/// `rays`: the suffixes, in the order of their tiles.
template <class Geometry, uint32_t features>
CASTRAY_STAGE void gather_environment(Context& c, const Vertices& x, const TileBoxes* boxes,
                                      const Suffixes& suffixes, const Paths& rays, const Hits& hits,
                                      VisibilityScratch& s, Gathered& gathered) {
  if (!c.scene.lights.has_environment) return;
  int k = 0;
  for (int tile = 0; tile < c.job.tiles; ++tile) {
    Gatherers gatherers{x, tile * tile_pixels, boxes[tile]};
    const float stratum = stratum_of(c, suffixes.origins[tile]);
    for (; k < rays.count; ++k) {
      const int suffix = (int)rays.names.slot[k] - batch_size;
      if (suffix >= (tile + 1) * tile_pixels) break;
      if (hits.primitive[k] != no_hit) continue;
      const Vec w = broadcast_entry(rays.d, k);
      Transfer t;
      transfer<Geometry, features>(c, FarSender{w, (int)suffixes.origin[suffix] - gatherers.first}, gatherers,
                                   s, t);
      const float density = ordered_sum(t.density) / stratum;
      if (!(density > 0)) continue;
      add_scaled<features>(gathered, gatherers.first, t,
                           escaped_light(c.scene.lights, w).radiance * Float(1.f / density));
    }
  }
}

}  // namespace castray::CASTRAY_ISA
