#include "cameras/camera.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "castray/error.h"
#include "castray/scene.h"
#include "core/put.h"
#include "core/range.h"

namespace castray {

namespace {

/// Unit vector, also where the squared length of `v` would overflow or vanish; (0,0,0) for (0,0,0).
Vec3d safe_normalize(const Vec3d& v) {
  const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  if (largest == 0) return v;
  int exponent;
  std::frexp(largest, &exponent);
  return normalize(Vec3d{std::ldexp(v.x, -exponent), std::ldexp(v.y, -exponent), std::ldexp(v.z, -exponent)});
}

}  // namespace

Camera make_camera(const Vec3d& position, const Vec3d& look_at, const Vec3d& up, double fov,
                   const Camera& rest) {
  for (const Vec3d& point : {position, look_at, up})
    for (int i = 0; i < 3; ++i)
      if (!coordinate_range.contains(point[i]))
        throw InputError(fmt::format("the camera's position, look_at and up must be {}, not {}",
                                     coordinate_range.text(), point[i]));
  if (!fov_range.contains(fov))
    throw InputError(fmt::format("the camera's fov must be {} degrees, not {}", fov_range.text(), fov));
  Camera camera = rest;
  camera.position = position;
  camera.forward = safe_normalize(look_at - position);
  if (camera.forward == Vec3d{} || !is_finite(camera.forward))
    throw InputError("the camera's look_at must differ from its position");
  if (up == Vec3d{}) throw InputError("the camera's up must not be (0,0,0)");
  const Vec3d right = cross(camera.forward, safe_normalize(up));
  constexpr double parallel = 1e-12;  // sine of the angle: below it, rounding alone decides what is up
  if (!(length(right) > parallel))
    throw InputError("the camera's up must not be parallel to its view direction");
  camera.right = normalize(right);
  camera.up = cross(camera.right, camera.forward);
  camera.tan_half_fov = std::tan(fov * std::numbers::pi / 360);
  return camera;
}

namespace {

Camera scaled(Camera camera, double factor) {
  camera.half_height *= factor;
  camera.lens.radius *= factor;
  camera.lens.focus_distance *= factor;
  return camera;
}

}  // namespace

Camera Scene::to_world(const Camera& camera) const {
  Camera moved = scaled(camera, unit);
  moved.position = to_world(camera.position);
  return moved;
}

Camera Scene::to_scene(const Camera& camera) const {
  Camera moved = scaled(camera, 1 / unit);
  moved.position = to_scene(camera.position);
  return moved;
}

Lens::Point Lens::sample(double u, double v) const {
  const double r = std::sqrt(u), turn = 2 * std::numbers::pi;
  if (blades == 0) return {r * std::cos(turn * v), r * std::sin(turn * v)};
  const double blade = std::floor(v * blades), along = 2 * (v * blades - blade) - 1;
  const double middle = turn * ((blade + 0.5) / blades + rotation / 360), half = std::numbers::pi / blades;
  const double out = r * std::cos(half), aside = r * std::sin(half) * along;
  return {out * std::sin(middle) + aside * std::cos(middle),
          out * std::cos(middle) - aside * std::sin(middle)};
}

CameraRay Camera::ray(double px, double py, int width, int height, double lens_u, double lens_v) const {
  if (projection == Projection::orthographic)
    return {position + in_plane(px, py, width, height, half_height), forward};
  if (projection == Projection::panorama) {
    const double turn = 2 * std::numbers::pi * (px / width - 0.5), down = std::numbers::pi * py / height;
    const Vec3d level = right * std::sin(turn) + forward * std::cos(turn);
    return {position, level * std::sin(down) + up * std::cos(down)};
  }
  const Vec3d through_middle = direction(px, py, width, height);
  if (!has_lens()) return {position, through_middle};
  const Lens::Point at = lens.sample(lens_u, lens_v);
  const Vec3d aside = (right * at.right + up * at.up) * lens.radius;
  return {position + aside, through_middle - aside / lens.focus_distance};
}

namespace {

KernelLens kernel_lens(const Camera& camera) {
  const Lens& lens = camera.lens;
  const double turn = lens.blades > 0 ? lens.rotation * std::numbers::pi / 180 : 0;
  KernelLens k{};
  put(k.right, (camera.right * std::cos(turn) - camera.up * std::sin(turn)) * lens.radius);
  put(k.up, (camera.up * std::cos(turn) + camera.right * std::sin(turn)) * lens.radius);
  k.inverse_focus = static_cast<float>(1 / lens.focus_distance);
  k.blades = static_cast<std::uint32_t>(lens.blades);
  if (lens.blades > 0) {
    k.apothem = static_cast<float>(std::cos(std::numbers::pi / lens.blades));
    k.half_blade = static_cast<float>(std::sin(std::numbers::pi / lens.blades));
  }
  return k;
}

}  // namespace

KernelCamera kernel_camera(const Camera& camera, int width, int height) {
  const auto place = [&](double px, double py) {
    return camera.projection == Projection::orthographic
               ? camera.in_plane(px, py, width, height, camera.half_height)
               : camera.direction(px, py, width, height);
  };
  KernelCamera k{};
  const Vec3d corner = place(0, 0);
  put(k.position, camera.position);
  put(k.corner, corner);
  put(k.dx, (place(width, 0) - corner) / double(width));
  put(k.dy, (place(0, height) - corner) / double(height));
  k.projection = static_cast<std::uint32_t>(camera.projection);
  put(k.forward, camera.forward);
  put(k.right, camera.right);
  put(k.up, camera.up);
  k.width = static_cast<float>(width);
  k.height = static_cast<float>(height);
  k.has_lens = camera.has_lens();
  if (k.has_lens) k.lens = kernel_lens(camera);
  return k;
}

double farthest_origin(const Camera& camera, int width, int height) {
  double farthest = length(camera.position);
  if (camera.has_lens()) farthest += camera.lens.radius;
  if (camera.projection == Projection::orthographic)
    for (const auto& [x, y] : {std::pair{0, 0}, {width, 0}, {0, height}, {width, height}})
      farthest = std::max(farthest, length(camera.ray(x, y, width, height, 0, 0).origin));
  return farthest;
}

}  // namespace castray
