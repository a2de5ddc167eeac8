#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "castray/scene.h"
#include "materials/ggx.h"
#include "materials/texture.h"

namespace castray {

/// A material's parameters at a point.
template <class T>
struct SurfaceValues {
  Vec3<T> kd, ks, reflectance, transmittance, ke;
  T alpha, metallic, coverage;

  explicit SurfaceValues(const Material& m)
      : kd(m.kd),
        ks(m.ks),
        reflectance(m.reflectance),
        transmittance(m.transmittance),
        ke(m.ke),
        alpha(std::max(static_cast<T>(m.alpha), m.has_alpha_map() ? Ggx<T>::smooth_below : T(0))),
        metallic(static_cast<T>(m.metallic)),
        coverage(static_cast<T>(m.coverage)) {}

  template <class U>
  explicit SurfaceValues(const SurfaceValues<U>& v)
      : kd(v.kd),
        ks(v.ks),
        reflectance(v.reflectance),
        transmittance(v.transmittance),
        ke(v.ke),
        alpha(static_cast<T>(v.alpha)),
        metallic(static_cast<T>(v.metallic)),
        coverage(static_cast<T>(v.coverage)) {}
};

/// A point on a triangle by its barycentrics.
template <class T>
struct TrianglePlace {
  std::uint32_t triangle;
  T b1, b2;

  template <class V>
  V interpolate(const V& at0, const V& at1, const V& at2) const {
    return at0 * (T(1) - b1 - b2) + at1 * b1 + at2 * b2;
  }
};

/// The texture coordinates of a point; none where its triangle has none.
template <class T>
std::optional<std::array<T, 2>> uv_at(const Scene& scene, const TrianglePlace<T>& place) {
  if (scene.triangle_uvs.empty()) return {};
  const Index3& index = scene.triangle_uvs[place.triangle];
  if (index[0] == Scene::no_index) return {};
  const auto axis = [&](std::size_t i) {
    return place.interpolate(T(scene.uvs[index[0]][i]), T(scene.uvs[index[1]][i]), T(scene.uvs[index[2]][i]));
  };
  return std::array<T, 2>{axis(0), axis(1)};
}

/// The interpolated colour of a triangle's vertices; white where they have none.
template <class T>
Vec3<T> vertex_color_at(const Scene& scene, const TrianglePlace<T>& place) {
  if (scene.triangle_colors.empty()) return Vec3<T>(1);
  const Index3& index = scene.triangle_colors[place.triangle];
  if (index[0] == Scene::no_index) return Vec3<T>(1);
  return place.interpolate(Vec3<T>(scene.colors[index[0]]), Vec3<T>(scene.colors[index[1]]),
                           Vec3<T>(scene.colors[index[2]]));
}

/// The one place where images become values: the parameters of `m` at a point of `scene`.
template <class T>
SurfaceValues<T> surface_values(const Scene& scene, const Material& m, const TrianglePlace<T>& place) {
  using P = SurfaceParameter;
  using V = SurfaceValues<T>;
  constexpr std::pair<P, Vec3<T> V::*> colors[] = {{P::kd, &V::kd},
                                                   {P::ks, &V::ks},
                                                   {P::reflectance, &V::reflectance},
                                                   {P::transmittance, &V::transmittance},
                                                   {P::ke, &V::ke}};
  constexpr std::pair<P, T V::*> numbers[] = {
      {P::alpha, &V::alpha}, {P::metallic, &V::metallic}, {P::coverage, &V::coverage}};
  V values(m);
  if (m.vertex_colors) values.kd *= vertex_color_at(scene, place);
  const auto uv = m.has_maps() ? uv_at(scene, place) : std::nullopt;
  if (!uv) return values;
  const auto [u, v] = *uv;
  const auto texture = [&](const TextureMap& map) -> const Texture& {
    return scene.textures[static_cast<std::size_t>(map.texture)];
  };
  for (const auto& [parameter, field] : colors)
    if (const TextureMap& map = m.map(parameter); map.used())
      values.*field *= map_color(texture(map), map, u, v);
  for (const auto& [parameter, field] : numbers)
    if (const TextureMap& map = m.map(parameter); map.used())
      values.*field = std::clamp(values.*field * map_number(texture(map), map, u, v), T(0), T(1));
  if (const TextureMap& map = m.map(P::roughness); map.used()) {
    const T factor = map_number(texture(map), map, u, v);
    values.alpha = std::clamp(values.alpha * factor * factor, T(0), T(1));
  }
  if (m.has_alpha_map()) values.alpha = std::max(values.alpha, Ggx<T>::smooth_below);
  return values;
}

/// The share of the surface that is there at a point.
template <class T>
T coverage_at(const Scene& scene, const TrianglePlace<T>& place) {
  const Material& m = scene.material_of(place.triangle);
  return m.map(SurfaceParameter::coverage).used() ? surface_values(scene, m, place).coverage
                                                  : static_cast<T>(m.coverage);
}

}  // namespace castray
