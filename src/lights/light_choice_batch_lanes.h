#pragma once

#include "lights/light_records.h"
#include "simd/isa_lanes.h"

namespace castray::CASTRAY_ISA {

void choose_lights(const LightList& list, const LightChoiceBatch& batch);

}  // namespace castray::CASTRAY_ISA
