#pragma once

#include "castray/render.h"
#include "wavefront/kernel_api.h"

namespace castray {

/// The fast integrator: the same expected image as castRay, by kernels that trace whole batches of paths.
/// Options are taken as checked by `render`.
RenderResult render_wavefront(const Scene& scene, const RenderOptions& options,
                              const ProgressCallback& progress, const Film* start);

}  // namespace castray
