#include "scene/gltf_lobe.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "materials/texture.h"

namespace castray {

namespace {

constexpr double least_ratio = 0.01;

struct Lobe {
  double alpha, anisotropy;
};

Lobe lobe_of(double roughness, double strength) {
  const double across = roughness * roughness, along = across + (1 - across) * strength * strength;
  const double ratio = along > 0 ? std::clamp(across / along, least_ratio, 1.0) : 1;
  return {along * std::sqrt(ratio), 1 - ratio};
}

const Texture& texture_of(const SceneBuilder& builder, const GltfNumber& number) {
  return builder.scene.textures[static_cast<std::size_t>(number.map.texture)];
}

/// A number as its image has it where that is (u,v), wherever it lies on the surface.
double value_at(const SceneBuilder& builder, const GltfNumber& number, double u, double v) {
  if (!number.varies()) return number.factor;
  TextureMap map = number.map;
  map.scale = {1, 1}, map.offset = {0, 0};
  return std::clamp(number.factor * map_number(texture_of(builder, number), map, u, v), 0.0, 1.0);
}

/// The image, as large as both, of what `value` makes of roughness and strength, in [0,1].
template <class Value>
Texture image_of(const SceneBuilder& builder, const GltfNumber& roughness, const GltfNumber& strength,
                 const Value& value) {
  Texture image{.name = "lobe", .channels = 1, .color_space = ColorSpace::linear};
  for (const GltfNumber* number : {&roughness, &strength})
    if (number->varies()) {
      image.name = texture_of(builder, *number).name;
      image.width = std::max(image.width, texture_of(builder, *number).width);
      image.height = std::max(image.height, texture_of(builder, *number).height);
    }
  image.bytes.reserve(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const double u = (x + 0.5) / image.width, v = 1 - (y + 0.5) / image.height;
      const Lobe lobe = lobe_of(value_at(builder, roughness, u, v), value_at(builder, strength, u, v));
      image.bytes.push_back(static_cast<std::uint8_t>(std::lround(255 * value(lobe))));
    }
  return image;
}

}  // namespace

void fold_constant(const SceneBuilder& builder, GltfNumber& number) {
  if (!number.varies()) return;
  const Texture& texture = texture_of(builder, number);
  const auto value = [&](std::size_t i) { return number_of_texel(texel(texture, i), number.map); };
  const std::size_t count =
      static_cast<std::size_t>(texture.width) * static_cast<std::size_t>(texture.height);
  for (std::size_t i = 1; i < count; ++i)
    if (value(i) != value(0)) return;
  number = {std::clamp(number.factor * double{value(0)}, 0.0, 1.0), {}};
}

bool lie_alike(const GltfNumber& a, const GltfNumber& b) {
  if (!a.varies() || !b.varies()) return true;
  return a.map.scale == b.map.scale && a.map.offset == b.map.offset && a.map.clamp == b.map.clamp;
}

void set_lobe(const GltfNumber& roughness, const GltfNumber& strength, SceneBuilder& builder, Material& m) {
  const GltfNumber& any = roughness.varies() ? roughness : strength;
  if (!any.varies()) {
    const Lobe lobe = lobe_of(roughness.factor, strength.factor);
    m.alpha = lobe.alpha, m.anisotropy = lobe.anisotropy;
    return;
  }
  const auto add = [&](SurfaceParameter parameter, const char* what, const auto& value) {
    const std::string name =
        fmt::format("{} of {} {} {} {} {} {}", what, roughness.map.texture, roughness.factor,
                    static_cast<int>(roughness.map.channel), strength.map.texture, strength.factor,
                    static_cast<int>(strength.map.channel));
    TextureMap map{.scale = any.map.scale, .offset = any.map.offset, .clamp = any.map.clamp};
    map.texture = builder.add_texture(name, [&] { return image_of(builder, roughness, strength, value); });
    m.map(parameter) = map;
  };
  add(SurfaceParameter::roughness, "roughness", [](const Lobe& lobe) { return std::sqrt(lobe.alpha); });
  add(SurfaceParameter::anisotropy, "anisotropy",
      [](const Lobe& lobe) { return lobe.anisotropy / (1 - least_ratio); });
  m.alpha = 1, m.anisotropy = 1 - least_ratio;
}

}  // namespace castray
