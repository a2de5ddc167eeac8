#include "scene/environment_reader.h"

#include <fmt/core.h>

#include <utility>

#include "core/files.h"
#include "core/text.h"
#include "materials/brightest_emission.h"
#include "materials/environment_image.h"
#include "materials/texture.h"
#include "scene/sky.h"
#include "scene/sun_position.h"

namespace castray {

namespace {

/// Texels of half a degree and less: the sun's disc is 0.53 degrees wide.
constexpr int sky_height = 512, gradient_height = 512;

/// Brings white in the sun near 1.
constexpr double default_sky_scale = 0.03;

int read_image(const JsonNode& node, const std::filesystem::path& file, SceneBuilder& builder) {
  return builder.add_texture(file_named_by(node, "\"image\"", file), ColorSpace::srgb);
}

/// "time" of a sky, if the sun's place follows from it.
const JsonNode* time_of_sun(const ObjectReader& reader) {
  const JsonNode* by_time = nullptr;
  for (const char* key : {"time", "latitude", "longitude"})
    if (const JsonNode* found = reader.find(key)) by_time = found;
  if (!by_time) return nullptr;
  for (const char* key : {"sun_elevation", "sun_azimuth"})
    if (const JsonNode* angle = reader.find(key))
      throw InputError(angle->key_place,
                       fmt::format("\"{}\" or \"{}\", not both: they place the sun", key, by_time->key));
  for (const char* key : {"latitude", "longitude"}) reader.require(key);
  return &reader.require("time");
}

void place_sun(const JsonNode& time, double latitude, double longitude, Sky& sky) {
  const std::optional<double> days = days_of(read_string(time, "\"time\""));
  if (!days)
    throw InputError(
        time.place,
        "\"time\" is one from 1900 to 2100 as \"2024-06-21T12:00Z\" or \"2024-06-21T14:00+02:00\"");
  const SunPosition sun = sun_position(*days, latitude, longitude);
  sky.sun_elevation = sun.elevation + refraction(sun.elevation);
  sky.sun_azimuth = sun.azimuth;
  if (sky.sun_elevation < 0)
    throw InputError(time.place,
                     fmt::format("the sun is {:.1f} degrees below the horizon then, at this latitude and "
                                 "longitude; choose another time",
                                 -sky.sun_elevation));
}

Texture read_sky(const JsonNode& node) {
  const ObjectReader reader(node, "\"sky\"", sky_keys);
  Sky sky;
  const auto read = [&reader](std::string_view key, double least, double greatest, double& value) {
    if (const JsonNode* found = reader.find(key))
      value = read_number(*found, fmt::format("\"{}\"", key), {.least = least, .greatest = greatest});
  };
  read("turbidity", least_turbidity, greatest_turbidity, sky.turbidity);
  read("sun_elevation", 0, 90, sky.sun_elevation);
  read("sun_azimuth", -360, 360, sky.sun_azimuth);
  if (const JsonNode* time = time_of_sun(reader)) {
    double latitude = 0, longitude = 0;
    read("latitude", -90, 90, latitude);
    read("longitude", -180, 180, longitude);
    place_sun(*time, latitude, longitude, sky);
  }
  if (const JsonNode* sun = reader.find("sun")) sky.sun = read_boolean(*sun, "\"sun\"");
  if (const JsonNode* ground = reader.find("ground"))
    sky.ground = read_color(*ground, "\"ground\"", unit_range);
  return make_texture("a clear sky", sky_image(sky, sky_height));
}

Texture read_gradient(const JsonNode& node) {
  const ObjectReader reader(node, "\"gradient\"", gradient_keys);
  const Vec3d zenith = read_color(reader.require("zenith"), "\"zenith\"", radiance_range);
  const Vec3d horizon = read_color(reader.require("horizon"), "\"horizon\"", radiance_range);
  const JsonNode* ground = reader.find("ground");
  const Vec3d below = ground ? read_color(*ground, "\"ground\"", radiance_range) : Vec3d();
  return make_texture("a gradient", gradient_image(zenith, horizon, below, gradient_height));
}

}  // namespace

void read_environment(const JsonNode& node, const std::filesystem::path& file, SceneBuilder& builder) {
  const ObjectReader environment(node, "\"environment\"", environment_keys);
  builder.environment_given = true;
  const JsonNode* kind = nullptr;
  for (const char* key : {"radiance", "image", "sky", "gradient"}) {
    const JsonNode* found = environment.find(key);
    if (found && kind)
      throw InputError(
          found->key_place,
          fmt::format("\"{}\" or \"{}\", not both; \"scale\" makes an image brighter", kind->key, key));
    if (found) kind = found;
  }
  Scene& scene = builder.scene;
  if (!kind || kind->key == "radiance") {
    scene.environment = read_color(environment.require("radiance"), "\"radiance\"", radiance_range);
    return;
  }
  EnvironmentImage& image = scene.environment_image;
  image.texture =
      kind->key == "image" ? read_image(*kind, file, builder) : builder.add_texture(kind->key, [kind] {
        return kind->key == "sky" ? read_sky(*kind) : read_gradient(*kind);
      });
  image.scale = kind->key == "sky" ? default_sky_scale : 1;
  if (const JsonNode* scale = environment.find("scale"))
    image.scale = read_number(*scale, "\"scale\"", radiance_range);
  if (const JsonNode* rotation = environment.find("rotation"))
    image.rotation = read_number(*rotation, "\"rotation\"", float_range);
  scene.environment = mean_environment(scene);
}

void replace_environment(const std::filesystem::path& image, Scene& scene) {
  SceneBuilder builder;
  builder.scene.environment_image.texture = builder.add_texture(image, ColorSpace::srgb);
  if (const double brightest = brightest_emission(builder.scene); !(brightest <= radiance_range.greatest))
    throw InputError(SourcePlace{image.string()},
                     fmt::format("its values are as great as {:.3g}; radiance must be {}", brightest,
                                 radiance_range.text()));
  scene.environment = mean_environment(builder.scene);
  scene.textures.push_back(std::move(builder.scene.textures.front()));
  scene.environment_image = {.texture = static_cast<int>(scene.textures.size()) - 1};
}

}  // namespace castray
