#include "scene/vertex_colors.h"

#include <algorithm>
#include <cmath>

#include "castray/image.h"

namespace castray {

void decode_colors(Mesh& mesh, float unit) {
  const ToneCurve srgb;
  for (Vec3f& color : mesh.colors)
    for (int i = 0; i < 3; ++i) {
      const float stored = color[i] / unit;
      color[i] = std::isfinite(stored) ? static_cast<float>(srgb.decode(std::clamp(stored, 0.f, 1.f))) : 0.f;
    }
}

void decode_vertex_colors(Mesh& mesh, float unit) {
  decode_colors(mesh, unit);
  mesh.triangle_colors = mesh.triangles;
}

}  // namespace castray
