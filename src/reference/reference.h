#pragma once

#include "castray/render.h"

namespace castray {

/// Renders with castRay (cast_ray.h), in float or double, over a BVH or a list; shows the classic faults
/// where asked. Options are taken as checked by `render`.
RenderResult render_reference(const Scene& scene, const RenderOptions& options,
                              const ProgressCallback& progress, const Film* start);

}  // namespace castray
