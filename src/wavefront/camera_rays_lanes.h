#pragma once

#include "wavefront/context_lanes.h"

// What a job begins with. None of it depends on a kernel's features.

namespace castray::CASTRAY_ISA {

/// Where the pixels of the job lie. Tiles of the first samples have ragged edges, as sharing over straight
/// ones would show.
void place_pixels(const Context& c, TileResult& pixels);

/// One ray for each pixel of the job, slot = its number.
void camera_rays(const Context& c, const TileResult& pixels, Paths& paths);

/// Without jitter all samples of a pixel start with the same ray: the table keeps its hit.
void keep_first_hits(const FirstHits& table, const TileResult& pixels, int count, const Hits& hits);
void recall_first_hits(const FirstHits& table, const TileResult& pixels, int count, Hits& hits);

}  // namespace castray::CASTRAY_ISA
