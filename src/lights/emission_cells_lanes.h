#pragma once

#include "lights/light_records.h"
#include "simd/vec_lanes.h"

namespace castray::CASTRAY_ISA {

/// EmissionCells::share of points on triangles that emit.
CASTRAY_INLINE Float cell_share(const CellTable& cells, Uint triangle, Float b1, Float b2) {
  const Uint first = gather(cells.first, triangle);
  const Mask none = first == Uint(no_cells);
  const Float steps(cells.steps), one(1.f), zero(0.f);
  const Float x = b1 * steps, y = b2 * steps;
  const Uint i = to_uint(max(min(x, steps - one), zero));
  const Uint j = to_uint(max(min(y, steps - one - to_float(i)), zero));
  const Mask upper = one < (x - to_float(i)) + (y - to_float(j));
  const Uint cell = (i * to_uint(steps) + j) * 2u + select(upper, Uint(1u), Uint(0u));
  return select(none, one, gather(cells.shares, select(none, Uint(0u), first + cell)));
}

}  // namespace castray::CASTRAY_ISA
