#include "scene/camera_reader.h"

#include <fmt/core.h>

#include "scene/material_reader.h"

namespace castray {

namespace {

/// The key of `reader` only goes with something else.
void refuse(const ObjectReader& reader, std::string_view key, std::string_view goes_with) {
  if (const JsonNode* node = reader.find(key))
    throw InputError(node->key_place, fmt::format("\"{}\" goes with {} only", key, goes_with));
}

/// By f-number N: the focal length, f = height of the sensor / (2 tan(fov / 2)), over 2 N.
double read_radius(const JsonNode& node, const ObjectReader& lens, double tan_half_fov) {
  const JsonNode *radius = lens.find("radius"), *f_number = lens.find("f_number");
  if (!radius == !f_number)
    throw InputError(node.place, "\"lens\" needs \"radius\" or \"f_number\", one of them");
  if (radius) {
    refuse(lens, "sensor_height", "\"f_number\"");
    return read_number(*radius, "\"radius\"", length_range);
  }
  const double height = read_number(lens.require("sensor_height"), "\"sensor_height\"", length_range);
  return height / (2 * tan_half_fov) / (2 * read_number(*f_number, "\"f_number\"", length_range));
}

/// Without a key: what is looked at is in focus.
double read_focus_distance(const ObjectReader& lens, const Camera& camera, const Vec3d& look_at) {
  const JsonNode *distance = lens.find("focus_distance"), *point = lens.find("focus_on");
  if (distance && point) throw InputError(point->key_place, "\"focus_distance\" or \"focus_on\", not both");
  if (distance) return read_number(*distance, "\"focus_distance\"", length_range);
  const Vec3d in_focus = point ? read_vector(*point, "\"focus_on\"", coordinate_range) : look_at;
  const double along = dot(in_focus - camera.position, camera.forward);
  if (!(along > 0)) throw InputError(point->place, "\"focus_on\" must lie in front of the camera");
  return along;
}

Lens read_lens(const JsonNode& node, const Camera& camera, const Vec3d& look_at) {
  const ObjectReader reader(node, "\"lens\"", lens_keys);
  Lens lens;
  lens.radius = read_radius(node, reader, camera.tan_half_fov);
  lens.focus_distance = read_focus_distance(reader, camera, look_at);
  if (const JsonNode* blades = reader.find("blades"))
    lens.blades = read_integer(*blades, "\"blades\"", 3, most_blades);
  else
    refuse(reader, "rotation", "\"blades\"");
  if (const JsonNode* rotation = reader.find("rotation"))
    lens.rotation = read_number(*rotation, "\"rotation\"", {.least = -360, .greatest = 360});
  return lens;
}

/// What is of one projection only, before the view is known.
Camera read_projection(const ObjectReader& reader) {
  Camera camera;
  if (const JsonNode* type = reader.find("type"))
    camera.projection =
        static_cast<Projection>(choose(*type, "\"type\"", {"perspective", "orthographic", "panorama"}));
  if (camera.projection == Projection::orthographic)
    camera.half_height = read_number(reader.require("height"), "\"height\"", length_range) / 2;
  else
    refuse(reader, "height", "\"type\": \"orthographic\"");
  if (camera.projection == Projection::panorama) refuse(reader, "shift", "cameras that are no panorama");
  if (camera.projection != Projection::perspective)
    for (const char* key : {"fov", "lens"}) refuse(reader, key, "\"type\": \"perspective\"");
  if (const JsonNode* shift = reader.find("shift")) {
    const std::vector<double> numbers =
        read_numbers(*shift, "\"shift\"", 2, {.least = -1000, .greatest = 1000});
    camera.shift_x = numbers[0], camera.shift_y = numbers[1];
  }
  return camera;
}

}  // namespace

Camera read_camera(const JsonNode& node) {
  const ObjectReader reader(node, "\"camera\"", camera_keys);
  const Camera projection = read_projection(reader);
  const Vec3d position = read_vector(reader.require("position"), "\"position\"", coordinate_range);
  const Vec3d look_at = read_vector(reader.require("look_at"), "\"look_at\"", coordinate_range);
  const JsonNode* up = reader.find("up");
  const JsonNode* fov = reader.find("fov");
  const double degrees = fov ? read_number(*fov, "\"fov\"", fov_range) : 40;
  Camera camera;
  try {
    camera =
        make_camera(position, look_at, up ? read_vector(*up, "\"up\"", coordinate_range) : Vec3d{0, 1, 0},
                    degrees, projection);
  } catch (const InputError& error) {
    throw InputError(node.place, error.what());
  }
  if (const JsonNode* lens = reader.find("lens")) camera.lens = read_lens(*lens, camera, look_at);
  return camera;
}

}  // namespace castray
