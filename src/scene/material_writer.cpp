#include "scene/material_writer.h"

#include <fmt/core.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "materials/descriptor.h"

namespace castray {

namespace {

using Json = nlohmann::ordered_json;
using Kind = MaterialKey::Kind;

/// The number of fewest digits that is read as `value`.
double shortest(float value) { return std::stod(fmt::format("{}", value)); }

Json constant_json(const MaterialKey& key, const Material& material) {
  const Vec3d value = value_of(key, material);
  const auto color = [](const Vec3d& v) { return Json::array({v.x, v.y, v.z}); };
  if (takes_index(key, material.type) && material.has_index())
    return {{"eta", color(material.eta)}, {"k", color(material.k)}};
  if (key.kind == Kind::color) return color(value);
  if (key.kind == Kind::flag) return value.x != 0;
  return key.kind == Kind::squared ? std::sqrt(value.x) : value.x;
}

Json map_json(const MaterialKey& key, const Material& material, const Scene& scene,
              const std::function<std::string(int)>& path_of) {
  const TextureMap& map = material.map(*key.parameter);
  const TextureMap none;
  const auto pair = [](const std::array<float, 2>& v) {
    return Json::array({shortest(v[0]), shortest(v[1])});
  };
  Json json = {{"image", path_of(map.texture)}};
  if (key.kind != Kind::image_only && value_of(key, material) != Vec3d(1))
    json["factor"] = constant_json(key, material);
  if (map.scale != none.scale) json["scale"] = pair(map.scale);
  if (map.offset != none.offset) json["offset"] = pair(map.offset);
  if (map.clamp) json["clamp"] = true;
  if (map.channel != none.channel) json["channel"] = channel_names()[static_cast<std::size_t>(map.channel)];
  const ColorSpace usual = key.kind == Kind::color ? ColorSpace::srgb : ColorSpace::linear;
  if (const ColorSpace space = scene.textures[static_cast<std::size_t>(map.texture)].color_space;
      space != usual)
    json["color_space"] = space == ColorSpace::srgb ? "srgb" : "linear";
  if (map.base != none.base) json["base"] = shortest(map.base);
  if (map.gain != none.gain) json["gain"] = shortest(map.gain);
  if (map.filter != none.filter) json["filter"] = filter_names()[static_cast<std::size_t>(map.filter)];
  return json;
}

/// Of "roughness" and "alpha", its square, one is written: that which has the image, else the roughness where
/// its square is exact.
bool is_other_width(const MaterialKey& key, const Material& material) {
  const bool is_roughness = key.parameter == SurfaceParameter::roughness;
  if (!is_roughness && key.parameter != SurfaceParameter::alpha) return false;
  if (material.has_alpha_map()) return !material.map(*key.parameter).used();
  const double root = std::sqrt(material.alpha);
  return is_roughness != (root * root == material.alpha);
}

}  // namespace

Json material_json(const Material& material, const Scene& scene,
                   const std::function<std::string(int)>& path_of) {
  const MaterialDescriptor& descriptor = descriptor_of(material.type);
  const Material usual{.name = {}};
  Json json = {{"type", descriptor.name}};
  for (const MaterialKey& key : descriptor.keys) {
    if (is_other_width(key, material)) continue;
    if (key.parameter && material.map(*key.parameter).used())
      json[std::string(key.name)] = map_json(key, material, scene, path_of);
    else if (key.kind != Kind::image_only && (key.brief || value_of(key, material) != value_of(key, usual)))
      json[std::string(key.name)] = constant_json(key, material);
  }
  return json;
}

}  // namespace castray
