#pragma once

#include "scene/mesh.h"

namespace castray {

/// Makes the colours of a mesh's vertices linear, one for each position, and gives them to its triangles. They
/// are as programs store them: by the curve of sRGB, in 0 .. `unit`; what is outside is clamped.
void decode_vertex_colors(Mesh& mesh, float unit);

}  // namespace castray
