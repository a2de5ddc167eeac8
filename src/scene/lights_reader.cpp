#include "scene/lights_reader.h"

#include <fmt/core.h>

#include <cmath>
#include <numbers>

#include "scene/material_reader.h"

namespace castray {

namespace {

using Kind = DeltaLight::Kind;

Vec3d read_direction(const JsonNode& node, const ObjectReader& reader, const Vec3d& position) {
  const JsonNode *direction = reader.find("direction"), *look_at = reader.find("look_at");
  if (!direction == !look_at)
    throw InputError(node.place, "the light needs \"direction\" or \"look_at\", one of them");
  const Vec3d d = direction ? read_vector(*direction, "\"direction\"", coordinate_range)
                            : read_vector(*look_at, "\"look_at\"", coordinate_range) - position;
  if (!(length(d) > 0) || !is_finite(d))
    throw InputError(direction ? direction->place : look_at->place,
                     "the light's direction must not be (0,0,0)");
  return normalize(d);
}

void read_cone(const ObjectReader& reader, DeltaLight& light) {
  const auto cosine = [](double degrees) { return std::cos(degrees * std::numbers::pi / 180); };
  const JsonNode *outer = reader.find("outer_angle"), *inner = reader.find("inner_angle");
  const double outside =
      outer ? read_number(*outer, "\"outer_angle\"", {.least = 0, .greatest = 180, .above_least = true}) : 45;
  const double inside = inner ? read_number(*inner, "\"inner_angle\"",
                                            {.least = 0, .greatest = outside, .below_greatest = true})
                              : 0;
  light.cos_outer = cosine(outside);
  light.cos_inner = cosine(inside);
}

}  // namespace

DeltaLight read_delta_light(const JsonNode& node) {
  const ObjectReader reader(node, "a light", light_keys);
  DeltaLight light;
  light.kind =
      static_cast<Kind>(choose(reader.require("type"), "\"type\"", {"point", "spot", "directional"}));
  const bool directional = light.kind == Kind::directional;
  const auto refuse = [&](const char* key, const char* of) {
    if (const JsonNode* found = reader.find(key))
      throw InputError(found->key_place, fmt::format("\"{}\" is not of {}", key, of));
  };
  if (directional) {
    for (const char* key : {"position", "look_at", "intensity"}) refuse(key, "a directional light");
  } else {
    refuse("irradiance", "a light at a point; it has \"intensity\"");
    light.position = read_vector(reader.require("position"), "\"position\"", coordinate_range);
  }
  if (light.kind == Kind::point)
    for (const char* key : {"direction", "look_at"}) refuse(key, "a point light");
  else
    light.direction = read_direction(node, reader, light.position);
  if (light.kind == Kind::spot)
    read_cone(reader, light);
  else
    for (const char* key : {"inner_angle", "outer_angle"}) refuse(key, "a light that is no spot");
  const char* brightness = directional ? "irradiance" : "intensity";
  light.intensity = read_color(reader.require(brightness), fmt::format("\"{}\"", brightness),
                               directional ? radiance_range : not_negative);
  return light;
}

}  // namespace castray
