#include "cli/scene_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace castray::cli {

namespace {

/// `x` with at most `decimals` of them.
std::string number(double x, int decimals) {
  std::string text = fmt::format("{:.{}f}", x, decimals);
  if (text.find('.') == text.npos) return text;
  text.erase(text.find_last_not_of('0') + 1);
  if (text.ends_with('.')) text.pop_back();
  return text == "-0" ? "0" : text;
}

std::string numbers(const Vec3d& v, int decimals, const char* separator) {
  return number(v.x, decimals) + separator + number(v.y, decimals) + separator + number(v.z, decimals);
}

struct View {
  std::string position, look_at, up, fov;
};

View view_of(const Scene& scene, const Camera& c, const char* separator) {
  constexpr int decimals = 6;
  const double distance = view_distance(c);
  return {world_point(scene, c.position, separator),
          world_point(scene, c.position + c.forward * distance, separator),
          numbers(c.up, decimals, separator),
          number(std::atan(c.tan_half_fov) * 360 / std::numbers::pi, decimals)};
}

std::string lens_json(const Lens& lens) {
  std::string text =
      fmt::format(R"("radius": {:.7g}, "focus_distance": {:.7g})", lens.radius, lens.focus_distance);
  if (lens.blades > 0) text += fmt::format(R"(, "blades": {}, "rotation": {:g})", lens.blades, lens.rotation);
  return fmt::format(R"("lens": {{ {} }})", text);
}

}  // namespace

bool is_dark(const Scene& scene) {
  return scene.lights.empty() && scene.delta_lights.empty() && max_component(scene.environment) == 0;
}

double view_distance(const Camera& camera) { return std::max(0.1, dot(-camera.position, camera.forward)); }

std::string world_point(const Scene& scene, const Vec3d& in_scene_space, const char* separator) {
  constexpr double told_apart = 0x1p-20;  // of `unit`: some floats' distance
  const int decimals = std::clamp(static_cast<int>(std::ceil(-std::log10(scene.unit * told_apart))), 0, 300);
  return numbers(scene.to_world(in_scene_space), decimals, separator);
}

std::string view_flags(const Scene& scene, const Camera& camera) {
  const View view = view_of(scene, camera, ",");
  return fmt::format("--look-from {} --look-at {} --up {} --fov {}", view.position, view.look_at, view.up,
                     view.fov);
}

std::string view_json(const Scene& scene, const Camera& in_scene) {
  const View view = view_of(scene, in_scene, ", ");
  const Camera camera = scene.to_world(in_scene);
  std::string text =
      fmt::format(R"("position": [{}], "look_at": [{}], "up": [{}])", view.position, view.look_at, view.up);
  if (camera.projection == Projection::perspective) text += fmt::format(R"(, "fov": {})", view.fov);
  if (camera.projection == Projection::orthographic)
    text += fmt::format(R"(, "type": "orthographic", "height": {:.7g})", 2 * camera.half_height);
  if (camera.projection == Projection::panorama) text += R"(, "type": "panorama")";
  if (camera.shift_x != 0 || camera.shift_y != 0)
    text += fmt::format(R"(, "shift": [{:g}, {:g}])", camera.shift_x, camera.shift_y);
  if (camera.has_lens()) text += ", " + lens_json(camera.lens);
  return fmt::format(R"("camera": {{ {} }})", text);
}

}  // namespace castray::cli
