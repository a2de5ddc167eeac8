#pragma once

#include "wavefront/branches_lanes.h"
#include "wavefront/camera_rays_lanes.h"
#include "wavefront/share_lanes.h"

// Renders a job from camera rays to radiance: with shared paths, or every pixel by itself.

namespace castray::CASTRAY_ISA {

CASTRAY_INLINE void copy_radiance(const Radiance& from, int count, float* const (&to)[3]) {
  for (int i = 0; i < count; ++i) {
    to[0][i] = from.x[i];
    to[1][i] = from.y[i];
    to[2][i] = from.z[i];
  }
}

template <class Geometry, uint32_t features>
CASTRAY_INLINE void render_tiles(const KernelScene& scene, const KernelOptions& options, const TileJob& job,
                                 void* scratch, TileResult& result) {
  Scratch& s = *static_cast<Scratch*>(scratch);
  Context c{scene, options, job, s.ends, world_key(options, job.sample)};
  if ((features & feature_materials) && options.light_paths) {
    c.left_to_light_paths = s.left_to_light_paths;
    for (uint32_t& left : s.left_to_light_paths) left = 1;
  }
  s.ends.fill();
  s.radiance.clear();
  place_pixels(c, result);
  PixelViews* const views = scene.filtered ? &s.views : nullptr;
  camera_rays(c, result, s.paths, views);
  const FirstHits& first = scene.first_hits;
  if (first.known)
    recall_first_hits(first, result, s.paths.count, s.hits);
  else
    closest<Geometry>(c, s.paths, true, s.hits, {s.paths.names.key, s.paths.names.index, options.sobol});
  if (first.t && !first.known) return keep_first_hits(first, result, s.paths.count, s.hits);
  absorb<Geometry>(c, s.hits, false, s.paths);
  surfaces<Geometry, features, true>(c, s.paths, s.hits, true, s.camera, s.radiance, false, views);
  if (result.emitted[0]) copy_radiance(s.radiance, job.tiles * tile_pixels, result.emitted);
  keep_direct(c, s);
  if (options.suffixes > 0 && may_have_edges(options, 2))
    share<Geometry, features>(c, s);
  else if (options.branches > 1 && may_have_edges(options, 2))
    follow_branches<Geometry, features>(c, s);
  else
    follow<Geometry, features>(c, s, s.camera, 0, options.first_roulette);
  clamp_indirect(c, s);
  copy_radiance(s.radiance, job.tiles * tile_pixels, result.radiance);
  result.rays += c.rays;
  result.gathered += c.gathered;
  result.asked += c.asked;
  result.evaluated += c.evaluated;
}

}  // namespace castray::CASTRAY_ISA
