#pragma once

#include "lights/light_records.h"
#include "simd/vec_lanes.h"

// Directions in which lights emit what mirrors and glass focus, as EmissionGuide has learned them.

namespace castray::CASTRAY_ISA {

/// By point: the first of its cell's cumulative probabilities.
struct GuideCell {
  Mask known;
  Uint row;
};

CASTRAY_INLINE GuideCell guide_cell(const EmissionGuideTable& table, const Vec& p) {
  if (!table.row_of_cell) return {Mask(false), Uint(0u)};
  const Vec at = (p - broadcast(table.lower)) * Float(table.cells_per_unit);
  const auto within = [](Float x, uint32_t count) { return (x >= Float(0.f)) & (x < Float((float)count)); };
  const Mask there =
      within(at.x, table.cells[0]) & within(at.y, table.cells[1]) & within(at.z, table.cells[2]);
  const auto whole = [&](Float x) { return to_uint(select(there, x, Float(0.f))); };
  const Uint cell = (whole(at.z) * table.cells[1] + whole(at.y)) * table.cells[0] + whole(at.x);
  const Uint row = gather(table.row_of_cell, cell);
  const Mask known = there & ~(row == Uint(no_guide));
  return {known, select(known, row, Uint(0u)) * (guide_bins + 1)};
}

/// The pdf of unit vector w, per solid angle. `row`: the first of the probabilities.
CASTRAY_INLINE Float pdf_of(const float* cumulative, Uint row, const Vec& w) {
  const Vec size = magnitude(w);
  const Float most = max_component(size);
  const Mask z = size.z >= most, y = ~z & (size.y >= most);
  const auto choose = [&](Float at_x, Float at_y, Float at_z) {
    return select(z, at_z, select(y, at_y, at_x));
  };
  const Float major = choose(w.x, w.y, w.z), scale = Float(0.5f * guide_steps) / most;
  const auto step = [&](Float v) {
    return to_uint(min(max(fma(v, scale, Float(0.5f * guide_steps)), Float(0.f)), Float(guide_steps - 0.5f)));
  };
  const Uint axis = select(z, Uint(2u), select(y, Uint(1u), Uint(0u)));
  const Uint face = axis * 2u + select(major < Float(0.f), Uint(1u), Uint(0u));
  const Uint a = step(choose(w.y, w.z, w.x)), b = step(choose(w.z, w.x, w.y));
  const Uint bin = row + (face * guide_steps + a) * guide_steps + b;
  const Float probability = gather(cumulative + 1, bin) - gather(cumulative, bin);
  return probability * Float(guide_steps * guide_steps / 4.f) / (most * most * most);
}

/// A unit vector, of the same row. `choice` chooses a bin, u and v a place in it.
CASTRAY_INLINE Vec direction_in(const float* cumulative, Uint row, Float choice, Float u, Float v) {
  Uint bin(0u);
  for (uint32_t step = guide_search; step > 0; step /= 2) {
    const Mask there = bin < Uint(guide_bins - step);
    const Uint next = select(there, bin + step, Uint(0u));
    const Mask beyond = there & (gather(cumulative, row + next) <= choice);
    bin = select(beyond, next, bin);
  }
  const Uint b = bin & (guide_steps - 1), a = (bin >> guide_step_bits) & (guide_steps - 1);
  const Uint face = bin >> (2 * guide_step_bits);
  const auto place = [](Uint step, Float within) {
    return fma(to_float(step) + within, Float(2.f / guide_steps), Float(-1.f));
  };
  const Float major = select((face & 1u) == Uint(1u), Float(-1.f), Float(1.f));
  const Float p = place(a, u), q = place(b, v);
  const Mask x = face < Uint(2u), z = ~(face < Uint(4u));
  const auto choose = [&](Float at_x, Float at_y, Float at_z) {
    return select(x, at_x, select(z, at_z, at_y));
  };
  return normalize(Vec{choose(major, q, p), choose(p, major, q), choose(q, p, major)});
}

}  // namespace castray::CASTRAY_ISA
