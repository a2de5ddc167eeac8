#include "cameras/pinhole.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "castray/error.h"
#include "core/put.h"

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

Camera make_camera(const Vec3d& position, const Vec3d& look_at, const Vec3d& up, double fov) {
  if (!is_finite(position) || !is_finite(look_at) || !is_finite(up))
    throw InputError("the camera's position, look_at and up must be finite");
  if (!(fov > 0 && fov < 180))
    throw InputError(
        fmt::format("the camera's fov must be greater than 0 and less than 180 degrees, not {}", fov));
  Camera camera;
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

KernelCamera kernel_camera(const Camera& camera, int width, int height) {
  KernelCamera k{};
  const Vec3d corner = camera.direction(0, 0, width, height);
  put(k.position, camera.position);
  put(k.corner, corner);
  put(k.dx, (camera.direction(width, 0, width, height) - corner) / double(width));
  put(k.dy, (camera.direction(0, height, width, height) - corner) / double(height));
  return k;
}

}  // namespace castray
