#pragma once

#include "lights/emission_guide_lanes.h"
#include "lights/light_regions_lanes.h"

namespace castray::CASTRAY_ISA {

/// Where the probabilities of a place's directions begin, as ArrivalGuide has learned them.
CASTRAY_INLINE Uint arrivals_at(const ArrivalGuideTable& table, const Vec& p) {
  return region_at(table.tree, p) * (guide_bins + 1);
}

/// The pdf of directions in which caustics are looked for, per solid angle.
CASTRAY_INLINE Float arrival_pdf(const ArrivalGuideTable& table, Uint row, const Vec& w) {
  return pdf_of(table.cumulative, row, w);
}

}  // namespace castray::CASTRAY_ISA
