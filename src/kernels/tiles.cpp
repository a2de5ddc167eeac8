#include "kernels/tiles.h"

#include "kernels/stages.h"

namespace castray::CASTRAY_ISA {

namespace {

struct Scratch {
  Paths paths;
  Hits hits;
  Vertices vertices;
  ShadowRays shadow_rays;
  Radiance radiance;
};

constexpr uint32_t first_roulette = 3;

bool may_add_edges(const KernelOptions& options, uint32_t edges) {
  return options.max_depth == 0 || edges <= options.max_depth;
}

/// Follows `paths` to their ends; the next vertex is number `vertex`.
void trace(Context& c, Scratch& s, uint32_t vertex) {
  for (; s.paths.count > 0; ++vertex) {
    closest(c, s.paths, vertex == 0, s.hits);
    surfaces(c, s.paths, s.hits, vertex == 0, s.vertices, s.radiance);
    if (!may_add_edges(c.options, vertex + 2)) return;
    light(c, s.vertices, vertex, s.shadow_rays);
    add_unblocked(c, s.shadow_rays, s.radiance);
    scatter(c, s.vertices, vertex, first_roulette, s.paths);
  }
}

}  // namespace

uint64_t scratch_bytes() { return sizeof(Scratch); }

void render_tiles(const KernelScene& scene, const KernelOptions& options, const TileJob& job, void* scratch,
                  TileResult& result) {
  Scratch& s = *static_cast<Scratch*>(scratch);
  Context c{scene, options, job};
  const int n = job.tiles * tile_pixels;
  for (int i = 0; i < n; ++i) s.radiance.x[i] = s.radiance.y[i] = s.radiance.z[i] = 0;
  camera_rays(c, s.paths);
  trace(c, s, 0);
  for (int i = 0; i < n; ++i) {
    result.radiance[0][i] = s.radiance.x[i];
    result.radiance[1][i] = s.radiance.y[i];
    result.radiance[2][i] = s.radiance.z[i];
  }
  result.rays += c.rays;
}

}  // namespace castray::CASTRAY_ISA
