#pragma once

#include "plan/plan.h"
#include "wavefront/kernel_api.h"

namespace castray {

/// Whether a render with this plan traces paths from lights.
bool traces_light_paths(const RenderOptions& options, const Plan& plan);

/// What kernels need to know of a render. `differences`: its films keep them.
KernelOptions kernel_options(const RenderOptions& options, const Plan& plan, bool differences);

}  // namespace castray
