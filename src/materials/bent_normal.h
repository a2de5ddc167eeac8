#pragma once

#include "geometry/placement.h"
#include "materials/surface_values.h"

namespace castray {

/// How a triangle's points move with its texture coordinates.
template <class T>
struct UvDerivatives {
  Vec3<T> du, dv;  ///< dp/du and dp/dv
  T handedness;    ///< -1 where the image is seen mirrored from the front
};

/// None where the triangle has no texture coordinates, or all three in one line.
template <class T, class Placement>
std::optional<UvDerivatives<T>> uv_derivatives(const Scene& scene, std::uint32_t triangle,
                                               const Placement& placement) {
  if (scene.triangle_uvs.empty() || scene.triangle_uvs[triangle][0] == Scene::no_index) return {};
  const Index3 &p = scene.triangles[triangle], &t = scene.triangle_uvs[triangle];
  const auto edge = [&](std::size_t i) {
    return placement.direction(Vec3<T>(scene.positions[p[i]]) - Vec3<T>(scene.positions[p[0]]));
  };
  const auto change = [&](std::size_t i, std::size_t axis) {
    return T(scene.uvs[t[i]][axis]) - T(scene.uvs[t[0]][axis]);
  };
  const T determinant = change(1, 0) * change(2, 1) - change(1, 1) * change(2, 0);
  if (!(std::abs(determinant) > 0)) return {};
  const Vec3<T> du = (edge(1) * change(2, 1) - edge(2) * change(1, 1)) / determinant;
  const Vec3<T> dv = (edge(2) * change(1, 0) - edge(1) * change(2, 0)) / determinant;
  if (!is_finite(du) || !is_finite(dv)) return {};
  return UvDerivatives<T>{du, dv, std::copysign(T(1), determinant) * T(placement.handedness())};
}

/// The shading normal `n`, on the geometric normal's side, as the material's normal and bump maps bend it.
///
/// A normal map holds (1 + m) / 2, m in the frame of n, the direction in which u grows and, across it, the
/// one in which v grows. A bump map is a height h along n (Blinn 1978): the normal is that of p + h n.
template <class T, class Placement>
Vec3<T> bent_normal(const Scene& scene, const Material& m, const TrianglePlace<T>& place,
                    const Placement& placement, Vec3<T> n) {
  const TextureMap &normals = m.map(SurfaceParameter::normal), &bump = m.map(SurfaceParameter::bump);
  if (!normals.used() && !bump.used()) return n;
  const auto derivatives = uv_derivatives<T>(scene, place.triangle, placement);
  const auto uv = uv_at(scene, place);
  if (!derivatives || !uv) return n;
  const auto [u, v] = *uv;
  const auto across = [&](const Vec3<T>& w) { return w - n * dot(n, w); };
  const auto texture = [&](const TextureMap& map) -> const Texture& {
    return scene.textures[static_cast<std::size_t>(map.texture)];
  };
  if (normals.used()) {
    const Vec3<T> tangent = normalize(across(derivatives->du));
    const Vec3<T> bitangent = cross(n, tangent) * derivatives->handedness;
    const Vec3<T> local = map_normal(texture(normals), normals, u, v);
    n = normalize(tangent * local.x + bitangent * local.y + n * local.z);
  }
  if (bump.used()) {
    const auto [hu, hv] = map_gradient(texture(bump), bump, u, v);
    const T height = T(1 / scene.unit);
    const Vec3<T> du = across(derivatives->du) + n * (hu * height),
                  dv = across(derivatives->dv) + n * (hv * height);
    n = normalize(cross(du, dv)) * derivatives->handedness;
  }
  return n;
}

}  // namespace castray
