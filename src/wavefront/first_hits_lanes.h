#pragma once

#include "wavefront/wave_lanes.h"

// Without jitter all samples of a pixel start with the same ray: its hit is found once.

namespace castray::CASTRAY_ISA {

CASTRAY_INLINE void keep_first_hits(const FirstHits& table, const TileResult& pixels, int count,
                                    const Hits& hits) {
  for (int i = 0; i < count; ++i) {
    const int x = (int)pixels.x[i] - table.x0, y = (int)pixels.y[i] - table.y0;
    if (x < 0 || x >= table.width || y < 0 || y >= table.height) continue;
    const int at = y * table.width + x;
    table.t[at] = hits.t[i];
    table.b1[at] = hits.b1[i];
    table.b2[at] = hits.b2[i];
    table.primitive[at] = hits.primitive[i];
  }
}

CASTRAY_INLINE void recall_first_hits(const FirstHits& table, const TileResult& pixels, int count,
                                      Hits& hits) {
  for (int i = 0; i < count; i += width) {
    const Uint x = load(pixels.x + i) - Uint((uint32_t)table.x0),
               y = load(pixels.y + i) - Uint((uint32_t)table.y0);
    const Uint at = y * Uint((uint32_t)table.width) + x;
    store(hits.t + i, gather(table.t, at));
    store(hits.b1 + i, gather(table.b1, at));
    store(hits.b2 + i, gather(table.b2, at));
    store(hits.primitive + i, gather(table.primitive, at));
  }
}

}  // namespace castray::CASTRAY_ISA
