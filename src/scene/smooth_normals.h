#pragma once

#include <cstdint>
#include <vector>

#include "scene/mesh.h"

namespace castray {

/// Replaces the mesh's shading normals by the mean of the faces' normals around each vertex, weighted by the
/// faces' angles there (Thuermer and Wuethrich 1998). Faces are smoothed with those of the same group, all
/// where `groups` is empty (else one a triangle; 0: not at all), whose normals are at most `crease_angle`
/// degrees from their own. Vertices at the same place count as one. A vertex of very many faces has no
/// creases.
void smooth_normals(Mesh& mesh, const std::vector<std::uint32_t>& groups, double crease_angle);

}  // namespace castray
