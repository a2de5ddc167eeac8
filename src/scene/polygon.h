#pragma once

#include <vector>

#include "castray/scene.h"
#include "castray/vec.h"

namespace castray {

/// Cuts a polygon, convex or not, into triangles by ear clipping: appends size - 2 triples of positions in
/// `corners`, each turning the same way as the polygon does. A polygon that crosses itself, has no area or is
/// not finite is cut in some way.
void triangulate(const std::vector<Vec3d>& corners, std::vector<Index3>& triangles);

}  // namespace castray
