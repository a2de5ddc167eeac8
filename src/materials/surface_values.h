#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "castray/scene.h"
#include "materials/descriptor.h"
#include "materials/footprint.h"
#include "materials/ggx.h"
#include "materials/texture.h"

namespace castray {

/// A material's values at a point, by ParameterSlot, as the scene has them.
template <class T>
struct SurfaceValues {
  std::array<T, parameter_floats> value{};

  explicit SurfaceValues(const Material& m) {
    for (const MaterialKey& key : descriptor_of(m.type).keys) {
      if (!key.slot || key.kind == MaterialKey::Kind::squared) continue;
      const Vec3d constant = value_of(key, m);
      for (int c = 0; c < floats_of(key); ++c) at(*key.slot + c) = static_cast<T>(constant[c]);
    }
    keep_alpha_rough(m);
  }

  template <class U>
  explicit SurfaceValues(const SurfaceValues<U>& v) {
    std::ranges::transform(v.value, value.begin(), [](U x) { return static_cast<T>(x); });
  }

  T& at(int slot) { return value[static_cast<std::size_t>(slot)]; }
  const T& at(int slot) const { return value[static_cast<std::size_t>(slot)]; }
  Vec3<T> color(int slot) const { return {at(slot), at(slot + 1), at(slot + 2)}; }

  /// Multiplies what `key` sets by what an image says; where the map filters, on the mean over what a pixel
  /// sees.
  void multiply(const MaterialKey& key, const Texture& texture, const TextureMap& map, T u, T v,
                const std::optional<Footprint<T>>& seen) {
    if (key.kind == MaterialKey::Kind::color) {
      const bool filters = seen && map.filter == TextureFilter::pixel;
      const Vec3<T> factor =
          filters ? footprint_color(texture, map, u, v, *seen) : map_color(texture, map, u, v);
      for (int c = 0; c < 3; ++c) at(*key.slot + c) *= factor[c];
    } else {
      const T factor = map_number(texture, map, u, v);
      const T power = key.kind == MaterialKey::Kind::squared ? factor * factor : factor;
      at(*key.slot) = std::clamp(at(*key.slot) * power, T(0), T(key.range.greatest));
    }
  }

  /// An image makes no lobe smooth.
  void keep_alpha_rough(const Material& m) {
    if (m.has_alpha_map()) at(slot_alpha) = std::max(at(slot_alpha), Ggx<T>::smooth_below);
  }
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

/// The one place where images become values: those of `m` at a point of `scene`. `seen`: the pixel's
/// footprint there, if a camera ray has found the point.
template <class T>
SurfaceValues<T> surface_values(const Scene& scene, const Material& m, const TrianglePlace<T>& place,
                                const std::optional<Footprint<T>>& seen = {}) {
  SurfaceValues<T> values(m);
  if (uses_vertex_colors(m)) {
    const Vec3<T> color = vertex_color_at(scene, place);
    for (int c = 0; c < 3; ++c) values.at(slot_kd + c) *= color[c];
  }
  const auto uv = m.has_maps() ? uv_at(scene, place) : std::nullopt;
  if (!uv) return values;
  for (const MaterialKey& key : descriptor_of(m.type).keys) {
    if (!key.slot || !key.parameter || !m.map(*key.parameter).used()) continue;
    const TextureMap& map = m.map(*key.parameter);
    values.multiply(key, scene.textures[static_cast<std::size_t>(map.texture)], map, (*uv)[0], (*uv)[1],
                    m.is_window() ? std::nullopt : seen);
  }
  values.keep_alpha_rough(m);
  return values;
}

/// The mean emission of a material, its image over its whole area and what of it is there: what lights are
/// chosen by. An image of the coverage does not count.
inline Vec3d mean_emission(const Scene& scene, const Material& m) {
  const TextureMap& map = m.map(SurfaceParameter::ke);
  const Vec3d constant = m.ke * m.coverage;
  if (!map.used() || scene.triangle_uvs.empty()) return constant;
  return constant * mean_color(scene.textures[static_cast<std::size_t>(map.texture)], map);
}

/// Of all materials.
inline std::vector<Vec3d> mean_emissions(const Scene& scene) {
  std::vector<Vec3d> mean;
  for (const Material& m : scene.materials) mean.push_back(mean_emission(scene, m));
  return mean;
}

/// The share of the surface that is there at a point.
template <class T>
T coverage_at(const Scene& scene, const TrianglePlace<T>& place) {
  const Material& m = scene.material_of(place.triangle);
  const TextureMap& map = m.map(SurfaceParameter::coverage);
  const auto constant = static_cast<T>(m.coverage);
  const auto uv = map.used() ? uv_at(scene, place) : std::nullopt;
  if (!uv) return constant;
  const Texture& texture = scene.textures[static_cast<std::size_t>(map.texture)];
  return std::clamp(constant * map_number(texture, map, (*uv)[0], (*uv)[1]), T(0), T(1));
}

}  // namespace castray
