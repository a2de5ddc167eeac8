#pragma once

#include "kernels/api.h"
#include "kernels/isa.h"

namespace castray::CASTRAY_ISA {

uint64_t scratch_bytes();
void render_tiles(const KernelScene&, const KernelOptions&, const TileJob&, void* scratch, TileResult&);

}  // namespace castray::CASTRAY_ISA
