#pragma once

#include "wavefront/context_lanes.h"

// What a job begins with. None of it depends on a kernel's features.

namespace castray::CASTRAY_ISA {

/// Places the pixels of a job, and looks up which of them see an edge. In the first samples tiles have ragged
/// edges: straight edges between tiles that share paths would be visible.
void place_pixels(const Context& c, TileResult& pixels);

/// One ray for each pixel of the job, slot = its number. `views`: what their pixels see; null where no map
/// filters.
void camera_rays(const Context& c, const TileResult& pixels, Paths& paths, PixelViews* views);

/// Without jitter all samples of a pixel have the same camera ray. The table keeps its hit.
void keep_first_hits(const FirstHits& table, const TileResult& pixels, int count, const Hits& hits);
void recall_first_hits(const FirstHits& table, const TileResult& pixels, int count, Hits& hits);

}  // namespace castray::CASTRAY_ISA
