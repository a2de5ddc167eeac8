#pragma once

#include "geometry/closed_surface.h"
#include "geometry/collapse.h"

namespace castray {

/// Fills in WideNode::normal and spread of a tree over triangles.
void bound_normals(WideTree& tree, const ClosedSurface& surface, int threads);

}  // namespace castray
