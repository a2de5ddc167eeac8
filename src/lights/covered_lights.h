#pragma once

#include <vector>

#include "castray/scene.h"
#include "geometry/facet_records.h"

namespace castray {

/// Whether something may lie so close in front of a light that a segment which ends there, and whose far end
/// is known to error_of_test of its length (core/error_bounds.h), would pass it: any triangle within 2^-16 of
/// the scene's size, unless it meets the light at a corner. True too where looking would take long.
bool may_be_covered(const Scene& scene, const std::vector<Facet>& lights);

}  // namespace castray
