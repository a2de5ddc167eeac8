#pragma once

#include "castray/render.h"
#include "geometry/ray.h"

namespace castray {

/// How many boxes of triangles a line through the mesh's box enters, on average, where cut boxes would spare
/// it: the sum of all triangles' boxes' surfaces, less those of ever smaller boxes along them, over the
/// surface of all. A line meets a convex body within another as often as their surfaces are to each other.
/// 2 or 3 for closed surfaces, however fine; hundreds where long triangles lie across the axes.
double wasted_boxes(const MeshView& mesh);

/// What `asked` means for a mesh. Boxes are cut if more than 256 are wasted (with fewer, the greater tree
/// costs as much as it spares); if it is left open, also only where it pays: each of `rays` gains 2 ns a
/// wasted box, and each triangle costs 1.6 us more to build (measured, docs/benchmarks.md).
BuildQuality choose_build(BuildQuality asked, double wasted, std::uint32_t triangles, double rays);

/// "auto", "fast" or "best".
const char* name_of(BuildQuality quality);

}  // namespace castray
