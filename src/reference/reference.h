#pragma once

#include <memory>

#include "plan/integrator.h"

namespace castray {

/// castRay (cast_ray.h), in float or double, over a BVH or a list; shows the classic faults where asked. The
/// scene must outlive it.
std::unique_ptr<const PreparedIntegrator> prepare_reference(const Scene& scene, const Job& job);

}  // namespace castray
