#pragma once

#include <vector>

#include "castray/scene.h"
#include "geometry/facet_records.h"
#include "lights/emission_cells.h"
#include "lights/light_records.h"

namespace castray {

/// What light sampling places points on: the parallelograms and triangles of the facets that emit, or the
/// triangles' cells. Without their densities and probabilities.
std::vector<KernelLight> light_shapes(const std::vector<Facet>& facets, const Scene& scene,
                                      const EmissionCells& cells);

}  // namespace castray
