#pragma once

#include "simd/isa_lanes.h"
#include "wavefront/kernel_api.h"

namespace castray::CASTRAY_ISA {

void evaluate_bsdfs(const KernelScene& scene, const BsdfBatch& batch);

}  // namespace castray::CASTRAY_ISA
