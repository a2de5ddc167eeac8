#pragma once

#include <vector>

#include "geometry/ray.h"

namespace castray {

/// The part of a mesh that is a surface with few free edges: what is left of it without the triangles that
/// have one. An edge is free unless as many triangles pass it in one direction as in the other; triangles
/// share an edge if they share the positions' indices.
struct ClosedSurface {
  std::vector<bool> has;  ///< by triangle
  std::vector<Index3>
      rim;  ///< free edges of this part, from the first index to the second, which the third repeats
};

/// Nothing is in it if its rim has more than an eighth as many edges as it has triangles.
ClosedSurface closed_surface(const MeshView& mesh, int threads);

}  // namespace castray
