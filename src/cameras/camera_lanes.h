#pragma once

#include "cameras/camera_records.h"
#include "simd/angles_lanes.h"
#include "simd/vec_lanes.h"

// Camera::ray in lanes, and the way back from a point to the image.

namespace castray::CASTRAY_ISA {

/// A camera ray; d is not of unit length.
struct CameraRay {
  Vec o, d;
};

/// From the middle of the lens to the point of it that u and v choose, uniform in area.
CASTRAY_INLINE Vec sample_lens(const KernelLens& lens, Float u, Float v) {
  const Vec right = broadcast(lens.right), up = broadcast(lens.up);
  const Float r = sqrt(u);
  if (lens.blades == 0) {
    const SinCos turn = sincos_turn(v);
    return fma(right, r * turn.cos, up * (r * turn.sin));
  }
  const Float blades((float)lens.blades);
  const Float blade = to_float(to_uint(v * blades));
  const Float along = fma(fma(v, blades, -blade), Float(2.f), Float(-1.f));
  const SinCos middle = sincos_turn((blade + Float(0.5f)) * Float(1.f / (float)lens.blades));
  const Float out = r * Float(lens.apothem), aside = r * Float(lens.half_blade) * along;
  return fma(right, fma(out, middle.sin, aside * middle.cos),
             up * fma(out, middle.cos, -(aside * middle.sin)));
}

/// An angle in turns, brought to [0,1).
CASTRAY_INLINE Float wrapped(Float turn) {
  const Float rest = turn - to_float(to_uint(turn));
  return select(rest < Float(0.f), rest + Float(1.f), rest);
}

CASTRAY_INLINE Vec panorama_direction(const KernelCamera& camera, Float px, Float py) {
  const SinCos round = sincos_turn(wrapped(px * Float(1.f / camera.width)));
  const SinCos down = sincos_turn(wrapped(py * Float(0.5f / camera.height)));
  const Vec level = -fma(broadcast(camera.right), round.sin, broadcast(camera.forward) * round.cos);
  return fma(level, down.sin, broadcast(camera.up) * down.cos);
}

/// Of sample (px,py) of the full image; the numbers u and v choose a point of the lens, if there is one.
CASTRAY_INLINE CameraRay camera_ray(const KernelCamera& camera, Float px, Float py, Float lens_u,
                                    Float lens_v) {
  const Vec position = broadcast(camera.position);
  if (camera.projection == panorama_rays) return {position, panorama_direction(camera, px, py)};
  const Vec place = fma(broadcast(camera.dx), px, fma(broadcast(camera.dy), py, broadcast(camera.corner)));
  if (camera.projection == orthographic_rays) return {position + place, broadcast(camera.forward)};
  if (!camera.has_lens) return {position, place};
  const Vec aside = sample_lens(camera.lens, lens_u, lens_v);
  return {position + aside, fma(aside, Float(-camera.lens.inverse_focus), place)};
}

/// Where a point is seen in the image.
struct SeenPoint {
  Vec origin;  ///< of the ray that sees it
  Float px, py;
  /// Area of the image, in pixels, over the solid angle in which it is seen from `origin`, or of orthographic
  /// rays, for the distance to the point; 0 behind the camera.
  Float pixels_per_solid_angle;
};

CASTRAY_INLINE SeenPoint see_by_perspective(const KernelCamera& camera, Vec p, Float lens_u, Float lens_v) {
  const Vec corner = broadcast(camera.corner), dx = broadcast(camera.dx), dy = broadcast(camera.dy);
  const Vec aside = camera.has_lens ? sample_lens(camera.lens, lens_u, lens_v) : black();
  const Vec origin = broadcast(camera.position) + aside, towards = p - origin;
  const Vec across = cross(dx, dy);
  const Float scale = dot(across, corner) / dot(across, towards);
  const Vec d = towards * scale, in_plane = fma(aside, Float(camera.lens.inverse_focus), d) - corner;
  const Float length2 = length_squared(d);
  const Float density = length2 * sqrt(length2) / abs(dot(across, d));
  return {origin, dot(in_plane, dx) / length_squared(dx), dot(in_plane, dy) / length_squared(dy),
          select(scale > Float(0.f), density, Float(0.f))};
}

CASTRAY_INLINE SeenPoint see_orthographically(const KernelCamera& camera, Vec p) {
  const Vec dx = broadcast(camera.dx), dy = broadcast(camera.dy), forward = broadcast(camera.forward);
  const Vec towards = p - broadcast(camera.position);
  const Float depth = dot(towards, forward);
  const Vec in_plane = towards - forward * depth - broadcast(camera.corner);
  const Float density = depth * depth / sqrt(length_squared(cross(dx, dy)));
  return {p - forward * depth, dot(in_plane, dx) / length_squared(dx), dot(in_plane, dy) / length_squared(dy),
          select(depth > Float(0.f), density, Float(0.f))};
}

CASTRAY_INLINE SeenPoint see_in_panorama(const KernelCamera& camera, Vec p) {
  const Vec origin = broadcast(camera.position), towards = p - origin;
  const Float x = -dot(towards, broadcast(camera.right)), z = -dot(towards, broadcast(camera.forward));
  const Float across = sqrt(fma(x, x, z * z)), length = sqrt(length_squared(towards));
  const Float pixels(camera.width * camera.height / (2 * pi * pi));
  return {origin, turn_of(x, z) * Float(camera.width),
          turn_of(across, dot(towards, broadcast(camera.up))) * Float(2 * camera.height),
          select(across > Float(0.f), pixels * length / across, Float(0.f))};
}

/// `p`: the point; the numbers u and v choose the point of the lens that sees it, if there is one.
CASTRAY_INLINE SeenPoint see_point(const KernelCamera& camera, Vec p, Float lens_u, Float lens_v) {
  if (camera.projection == orthographic_rays) return see_orthographically(camera, p);
  if (camera.projection == panorama_rays) return see_in_panorama(camera, p);
  return see_by_perspective(camera, p, lens_u, lens_v);
}

}  // namespace castray::CASTRAY_ISA
