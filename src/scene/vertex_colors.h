#pragma once

#include "scene/mesh.h"

namespace castray {

/// Makes a mesh's colours linear. They are as programs store them: by the curve of sRGB, in 0 .. `unit`; what
/// is outside is clamped.
void decode_colors(Mesh& mesh, float unit);

/// The same of colours of vertices, one for each position, which it gives to the triangles.
void decode_vertex_colors(Mesh& mesh, float unit);

}  // namespace castray
