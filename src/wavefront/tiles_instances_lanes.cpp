#include "geometry/instance_geometry_lanes.h"
#include "wavefront/render_tiles_lanes.h"
#include "wavefront/tiles_lanes.h"

namespace castray::CASTRAY_ISA {

void render_tiles_instances(const KernelScene& scene, const KernelOptions& options, const TileJob& job,
                            void* scratch, TileResult& result) {
  render_tiles<InstanceGeometry, feature_materials | feature_detail>(scene, options, job, scratch, result);
}

}  // namespace castray::CASTRAY_ISA
