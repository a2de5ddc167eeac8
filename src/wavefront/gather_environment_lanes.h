#pragma once

#include "lights/environment_lanes.h"
#include "wavefront/gather_light_lanes.h"
#include "wavefront/suffixes_lanes.h"

namespace castray::CASTRAY_ISA {

/// What the pixels of a tile gather from a direction to the environment. Directions come from the tile's
/// suffixes that escaped, and from environment samples: the balance heuristic over all.
template <class Geometry, uint32_t features>
CASTRAY_STAGE void gather_direction(Context& c, const FarSender& y, const EscapedLight& light,
                                    const Origins& origins, float stratum, Gatherers& gatherers,
                                    VisibilityScratch& s, Gathered& gathered) {
  Transfer t;
  transfer<Geometry, features>(c, y, gatherers, s, t);
  const float found = found_from(origins, t.density) / stratum;
  const float density = found + (float)c.options.environment_points * lane(light.density, 0);
  if (!(density > 0)) return;
  add_scaled<features>(gathered, gatherers.first, t, light.radiance * Float(1.f / density));
}

/// Every pixel of a tile gathers what arrives from outside. `rays`: the suffixes, in the order of their
/// tiles.
template <class Geometry, uint32_t features>
CASTRAY_STAGE void gather_environment(Context& c, const Vertices& x, const TileBoxes* boxes,
                                      const Suffixes& suffixes, const Paths& rays, const Hits& hits,
                                      VisibilityScratch& s, Gathered& gathered) {
  const EnvironmentTable& environment = c.scene.lights.environment;
  if (!environment.shines) return;
  const auto points = (uint32_t)c.options.environment_points;
  int k = 0;
  for (int tile = 0; tile < c.job.tiles; ++tile) {
    Gatherers gatherers{x, tile * tile_pixels, boxes[tile]};
    const Origins& origins = suffixes.origins[tile];
    const float stratum = stratum_of(c, origins);
    for (; k < rays.count; ++k) {
      const int suffix = (int)rays.names.slot[k] - batch_size;
      if (suffix >= (tile + 1) * tile_pixels) break;
      if (hits.primitive[k] != no_hit) continue;
      const Vec w = broadcast_entry(rays.d, k);
      gather_direction<Geometry, features>(c, {w, (int)suffixes.origin[suffix] - gatherers.first},
                                           light_from(environment, w), origins, stratum, gatherers, s,
                                           gathered);
    }
    const TileSequence sequence = tile_sequence(c, tile);
    for (uint32_t first = 0; first < points; first += width) {
      const Uint index = tile_index(sequence, Uint(first) + lane_index(), points);
      const Numbers<2> n = draw<2>(c.options.sobol, {Uint(sequence.key), index}, PathBlocks::environment(0));
      const EnvironmentSample sample = sample_environment(environment, n.u[0], n.u[1]);
      for (int l = 0; l < width && first + (uint32_t)l < points; ++l)
        gather_direction<Geometry, features>(
            c, {broadcast_lane(sample.w, l), -1},
            {broadcast_lane(sample.light.radiance, l), Float(lane(sample.light.density, l))}, origins,
            stratum, gatherers, s, gathered);
    }
  }
}

}  // namespace castray::CASTRAY_ISA
