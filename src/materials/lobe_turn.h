#pragma once

#include <array>
#include <cmath>

#include "materials/surface_values.h"

namespace castray {

/// Cosine and sine of the angle at which a material's lobes are wide at a point, from the direction in which
/// u grows towards that of v: by the image of directions, if there is one, and turned by anisotropy_rotation.
template <class T>
std::array<T, 2> lobe_turn(const Scene& scene, const Material& m, const TrianglePlace<T>& place) {
  T degrees = T(m.anisotropy_rotation), x = 1, y = 0;
  const TextureMap &turns = m.map(SurfaceParameter::anisotropy_rotation),
                   &directions = m.map(SurfaceParameter::anisotropy_direction);
  const auto texture = [&](const TextureMap& map) -> const Texture& {
    return scene.textures[static_cast<std::size_t>(map.texture)];
  };
  const auto uv = turns.used() || directions.used() ? uv_at(scene, place) : std::nullopt;
  if (uv && turns.used()) degrees *= map_number(texture(turns), turns, (*uv)[0], (*uv)[1]);
  if (uv && directions.used()) {
    const Vec3<T> d = map_normal(texture(directions), directions, (*uv)[0], (*uv)[1]);
    if (d.x * d.x + d.y * d.y > T(least_direction2)) x = d.x, y = d.y;
  }
  const T turn = degrees * pi<T> / 180, c = std::cos(turn), s = std::sin(turn);
  return {c * x - s * y, s * x + c * y};
}

}  // namespace castray
