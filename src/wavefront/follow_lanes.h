#pragma once

#include "wavefront/clamp_lanes.h"
#include "wavefront/light_lanes.h"
#include "wavefront/scatter_lanes.h"
#include "wavefront/surfaces_lanes.h"
#include "wavefront/trace_lanes.h"

// The stages that a batch of paths goes through, each from arrays to arrays:
//
//   camera_rays -> Paths -> closest -> Hits -> surfaces -> Vertices -> light -> ShadowRays -> add_unblocked
//                    ^                                        |
//                    +------------------- scatter <-----------+
//
// Where glass absorbs, `absorb` dims the paths between closest and surfaces.

namespace castray::CASTRAY_ISA {

/// Roulette starts later for suffixes: each serves many pixels.
inline constexpr uint32_t first_roulette_of_suffixes = 4;

CASTRAY_INLINE bool may_have_edges(const KernelOptions& options, uint32_t edges) {
  return options.max_depth == 0 || edges <= options.max_depth;
}

/// Light samples at vertices that are number `vertex` of their paths.
template <class Geometry, uint32_t features>
CASTRAY_STAGE void light_vertices(Context& c, Scratch& s, const Vertices& vertices, uint32_t vertex) {
  if (c.scene.lights.count > 0) {
    light<Geometry, features>(c, vertices, vertex, s.shadow_rays);
    add_unblocked<Geometry>(c, s.shadow_rays, s.radiance);
  }
  if (c.scene.lights.environment.width > 0) {
    light_environment<Geometry, features>(c, vertices, vertex, s.shadow_rays);
    add_unblocked<Geometry>(c, s.shadow_rays, s.radiance);
  }
  if (c.scene.lights.deltas.count > 0) {
    light_deltas<Geometry, features>(c, vertices, vertex, s.shadow_rays);
    add_unblocked<Geometry>(c, s.shadow_rays, s.radiance);
  }
}

/// Follows paths from their vertices, which are number `vertex` of each path, to the end: a light sample
/// at each vertex, unless the first ones are `lit`, then the next ray. With `chains` only to the ends of
/// these.
template <class Geometry, uint32_t features>
CASTRAY_STAGE void follow(Context& c, Scratch& s, Vertices& vertices, uint32_t vertex, uint32_t roulette,
                          Chains* chains = nullptr, bool lit = false) {
  const bool may_find_lights = c.options.mis || (features & feature_materials);
  Vertices* current = &vertices;
  for (; may_have_edges(c.options, vertex + 2); ++vertex) {
    if (!lit) {
      light_vertices<Geometry, features>(c, s, *current, vertex);
      if (vertex == 0) keep_direct(c, s);
    }
    lit = false;
    scatter<features>(c, *current, vertex, roulette, s.paths);
    if (s.paths.count == 0) return;
    closest<Geometry>(c, s.paths, false, s.hits);
    absorb<Geometry>(c, s.hits, false, s.paths);
    surfaces<Geometry, features, false>(c, s.paths, s.hits, may_find_lights, s.vertices, s.radiance);
    current = &s.vertices;
    if (chains) take_chain_ends(c, *current, *chains);
  }
}

}  // namespace castray::CASTRAY_ISA
