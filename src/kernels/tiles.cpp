#include "kernels/tiles.h"

#include "kernels/reuse.h"
#include "kernels/stages.h"

namespace castray::CASTRAY_ISA {

namespace {

struct Scratch {
  Paths paths;
  Hits hits;
  Vertices camera, vertices;
  ShadowRays shadow_rays;
  Radiance radiance;
  Suffixes suffixes;
  Gathered gathered;
  Shaft shaft;
  Box boxes[max_tiles];
};

bool may_have_edges(const KernelOptions& options, uint32_t edges) {
  return options.max_depth == 0 || edges <= options.max_depth;
}

/// Lights the vertices, which are number `vertex` of their paths, and follows the paths to their ends.
void follow(Context& c, Scratch& s, Vertices& vertices, uint32_t vertex, uint32_t first_roulette) {
  Vertices* current = &vertices;
  for (;; ++vertex) {
    if (!may_have_edges(c.options, vertex + 2)) return;
    light(c, *current, vertex, s.shadow_rays);
    add_unblocked(c, s.shadow_rays, s.radiance);
    if (!may_have_edges(c.options, vertex + 3)) return;
    scatter(c, *current, vertex, first_roulette, s.paths);
    if (s.paths.count == 0) return;
    closest(c, s.paths, false, s.hits);
    surfaces<false>(c, s.paths, s.hits, false, s.vertices, s.radiance);
    current = &s.vertices;
  }
}

void share(Context& c, Scratch& s) {
  const int n = c.job.tiles * tile_pixels;
  for (int i = 0; i < n; ++i) s.gathered.sum.x[i] = s.gathered.sum.y[i] = s.gathered.sum.z[i] = 0;
  for (int tile = 0; tile < c.job.tiles; ++tile) s.boxes[tile] = bounds_of({s.camera, tile * tile_pixels});
  if (may_have_edges(c.options, 2)) gather_light(c, s.camera, s.boxes, s.shaft, s.gathered);
  if (may_have_edges(c.options, 3)) {
    start_suffixes(c, s.camera, s.suffixes, s.paths);
    closest(c, s.paths, false, s.hits);
    surfaces<false>(c, s.paths, s.hits, false, s.vertices, s.radiance);
    keep_suffixes(s.vertices, s.suffixes);
    follow(c, s, s.vertices, 1, 4);
    gather_suffixes(c, s.camera, s.boxes, s.suffixes, s.radiance, s.shaft, s.gathered);
  }
  for (int i = 0; i < n; ++i) {
    s.radiance.x[i] += s.camera.albedo.x[i] * s.gathered.sum.x[i];
    s.radiance.y[i] += s.camera.albedo.y[i] * s.gathered.sum.y[i];
    s.radiance.z[i] += s.camera.albedo.z[i] * s.gathered.sum.z[i];
  }
}

}  // namespace

uint64_t scratch_bytes() { return sizeof(Scratch); }

void render_tiles(const KernelScene& scene, const KernelOptions& options, const TileJob& job, void* scratch,
                  TileResult& result) {
  Scratch& s = *static_cast<Scratch*>(scratch);
  Context c{scene, options, job};
  const int n = job.tiles * tile_pixels;
  for (int i = 0; i < 2 * batch_size; ++i) s.radiance.x[i] = s.radiance.y[i] = s.radiance.z[i] = 0;
  camera_rays(c, s.paths);
  closest(c, s.paths, true, s.hits);
  s.camera.count = 0;
  surfaces<true>(c, s.paths, s.hits, true, s.camera, s.radiance);
  if (options.suffixes > 0)
    share(c, s);
  else
    follow(c, s, s.camera, 0, 3);
  for (int i = 0; i < n; ++i) {
    result.radiance[0][i] = s.radiance.x[i];
    result.radiance[1][i] = s.radiance.y[i];
    result.radiance[2][i] = s.radiance.z[i];
  }
  result.rays += c.rays;
}

}  // namespace castray::CASTRAY_ISA
