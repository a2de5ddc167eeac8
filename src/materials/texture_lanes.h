#pragma once

#include "geometry/hit_point_lanes.h"

// Textures and smooth normals, interpolated over a triangle.

namespace castray::CASTRAY_ISA {

inline constexpr uint32_t no_corner = 0xffffffffu;

/// The interpolated vertex normal, on the side of `facing` (the geometric normal on the viewer's side);
/// `facing` itself where there is none or where the viewer would be behind it.
CASTRAY_INLINE Vec smooth_normal(const TriangleTable& table, Uint triangle, Float b1, Float b2, Vec facing,
                                 Vec to_viewer) {
  if (!table.normal_corners) return facing;
  Corners corners = corners_of(table.normal_corners, triangle);
  const Mask none = corners.a == Uint(no_corner);
  const auto normal = [&](Uint i) { return gather_vec(table.normals, select(none, Uint(0u), i) * 3u); };
  Vec n = normal(corners.a) * (Float(1.f) - b1 - b2) + normal(corners.b) * b1 + normal(corners.c) * b2;
  n = normalize(n);
  n = select(dot(n, facing) < Float(0.f), -n, n);
  const Mask usable = ~none & (dot(n, to_viewer) > Float(0.f)) & (length_squared(n) > Float(0.f));
  return select(usable, n, facing);
}

/// Bilinear look-up at (u,v), v upwards, repeated over the plane; texel centres are at half integers.
CASTRAY_INLINE Vec lookup(const KernelTexture& texture, Float u, Float v) {
  const Float w((float)texture.width), h((float)texture.height);
  const auto floor = [](Float x) {
    const Float whole = to_float(to_uint(x));
    return whole - select(whole > x, Float(1.f), Float(0.f));
  };
  const auto wrap = [](Float i, Float size) {
    return select(i < Float(0.f), i + size, select(i >= size, i - size, i));
  };
  const Float x = (u - floor(u)) * w - Float(0.5f), y = (Float(1.f) - (v - floor(v))) * h - Float(0.5f);
  const Float x0 = floor(x), y0 = floor(y), s = x - x0, t = y - y0;
  const auto texel = [&](Float tx, Float ty) {
    const Uint at = to_uint(wrap(ty, h)) * Uint((uint32_t)texture.width) + to_uint(wrap(tx, w));
    return gather_vec(texture.texels, at * 3u);
  };
  const Vec top = texel(x0, y0) * (Float(1.f) - s) + texel(x0 + Float(1.f), y0) * s;
  const Vec bottom =
      texel(x0, y0 + Float(1.f)) * (Float(1.f) - s) + texel(x0 + Float(1.f), y0 + Float(1.f)) * s;
  return top * (Float(1.f) - t) + bottom * t;
}

/// What the texture of each lane's material multiplies kd by.
CASTRAY_INLINE Vec texture_tint(const KernelScene& scene, Uint material, Uint triangle, Float b1, Float b2) {
  const Vec white{Float(1.f), Float(1.f), Float(1.f)};
  const TriangleTable& table = scene.triangles;
  if (!table.uv_corners || scene.texture_count == 0) return white;
  const Uint texture = gather(&scene.materials->texture, material);
  const Corners corners = corners_of(table.uv_corners, triangle);
  const Mask none = corners.a == Uint(no_corner);
  const auto interpolate = [&](uint32_t axis) {
    const auto at = [&](Uint i) { return gather(table.uvs, select(none, Uint(0u), i) * 2u + axis); };
    return at(corners.a) * (Float(1.f) - b1 - b2) + at(corners.b) * b1 + at(corners.c) * b2;
  };
  const Float u = interpolate(0), v = interpolate(1);
  Vec tint = white;
  for (uint32_t k = 0; k < scene.texture_count; ++k) {
    const Mask here = (texture == Uint(k + 1)) & ~none;
    if (any(here)) tint = select(here, lookup(scene.textures[k], u, v), tint);
  }
  return tint;
}

}  // namespace castray::CASTRAY_ISA
