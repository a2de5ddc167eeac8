#include "geometry/list_geometry_lanes.h"
#include "wavefront/light_paths_lanes.h"
#include "wavefront/render_tiles_lanes.h"
#include "wavefront/tiles_lanes.h"

namespace castray::CASTRAY_ISA {

void render_tiles_list(const KernelScene& scene, const KernelOptions& options, const TileJob& job,
                       void* scratch, TileResult& result) {
  render_tiles<ListGeometry, feature_materials>(scene, options, job, scratch, result);
}

uint64_t trace_light_paths_list(const KernelScene& scene, const KernelOptions& options,
                                const LightPathJob& job, void* scratch, const SplatSink& sink) {
  return trace_light_paths<ListGeometry, feature_materials>(scene, options, job, scratch, sink);
}

}  // namespace castray::CASTRAY_ISA
