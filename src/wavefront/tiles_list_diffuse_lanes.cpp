#include "geometry/list_geometry_lanes.h"
#include "wavefront/render_tiles_lanes.h"
#include "wavefront/tiles_lanes.h"

namespace castray::CASTRAY_ISA {

void render_tiles_list_diffuse(const KernelScene& scene, const KernelOptions& options, const TileJob& job,
                               void* scratch, TileResult& result) {
  render_tiles<ListGeometry, 0>(scene, options, job, scratch, result);
}

}  // namespace castray::CASTRAY_ISA
