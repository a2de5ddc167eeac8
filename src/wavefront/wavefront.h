#pragma once

#include <memory>

#include "plan/integrator.h"

namespace castray {

/// The fast integrator: the same expected image as castRay, by kernels that trace whole batches of paths. The
/// scene must outlive it.
std::unique_ptr<const PreparedIntegrator> prepare_wavefront(const Scene& scene, const Job& job);

}  // namespace castray
