#pragma once

#include "simd/lanes.h"

// The lanes' side of lights/light_share.h. The densities are of a tile's light points and suffixes, or of one
// vertex's light point and direction.

namespace castray::CASTRAY_ISA {

CASTRAY_INLINE Float light_share(Float light, Float bsdf) {
  return light / max(max(light, bsdf), Float(0x1p-100f));
}

CASTRAY_INLINE Float bsdf_share(Float light, Float bsdf) {
  return max(bsdf - light, Float(0.f)) / max(bsdf, Float(0x1p-100f));
}

}  // namespace castray::CASTRAY_ISA
