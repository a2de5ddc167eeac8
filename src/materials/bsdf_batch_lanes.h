#pragma once

#include "materials/kernel_material.h"
#include "simd/isa_lanes.h"

namespace castray::CASTRAY_ISA {

void evaluate_bsdfs(const MaterialTables& tables, const BsdfBatch& batch);

}  // namespace castray::CASTRAY_ISA
