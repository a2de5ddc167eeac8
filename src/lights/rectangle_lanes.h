#pragma once

#include "simd/vec_lanes.h"

namespace castray::CASTRAY_ISA {

/// A rectangle as seen from the origin: a corner, two perpendicular edges, and its unit normal.
struct SeenRectangle {
  Vec corner, edge1, edge2, normal;
};

/// corner + a edge1 + b edge2. Not valid where the rectangle is seen so small that the solid angle, a
/// difference of angles, would be rounding: there area sampling is as good.
struct RectanglePoint {
  Float a, b;
  Float inverse_density;  ///< with respect to area
  Mask valid;
};

/// acos(x) for x in [-1,1] within 2e-7: asin's Taylor series up to x^17 on [0,1/2], elsewhere the half
/// angle's.
CASTRAY_INLINE Float acos(Float x) {
  const Float size = abs(x);
  const Mask small = size <= Float(0.5f);
  const Float s = select(small, size, sqrt(max(fma(size, Float(-0.5f), Float(0.5f)), Float(0.f)))), z = s * s;
  constexpr float coefficient[] = {143.f / 10240, 231.f / 13312, 63.f / 2816, 35.f / 1152,
                                   5.f / 112,     3.f / 40,      1.f / 6};
  Float series(6435.f / 557056);
  for (const float next : coefficient) series = fma(series, z, Float(next));
  const Float asin = fma(series * z, s, s);
  const Float of_size = select(small, Float(1.57079632679f) - asin, asin + asin);
  return select(x < Float(0.f), Float(3.14159265359f) - of_size, of_size);
}

/// A point uniform in solid angle: Urena, Fajardo, King 2013, "An Area-Preserving Parametrization for
/// Spherical Rectangles".
CASTRAY_INLINE RectanglePoint sample_seen_rectangle(const SeenRectangle& r, Float u, Float v) {
  const Float length1 = sqrt(length_squared(r.edge1)), length2 = sqrt(length_squared(r.edge2));
  const Float x0 = dot(r.corner, r.edge1) / length1, y0 = dot(r.corner, r.edge2) / length2;
  const Float x1 = x0 + length1, y1 = y0 + length2, z = -abs(dot(r.corner, r.normal)), z2 = z * z;
  // normals of the planes through the origin and each edge: along z, and along the other axis that is not 0
  const auto along_z = [&](Float s) { return s / sqrt(max(fma(s, s, z2), Float(0x1p-100f))); };
  const Float n0 = -along_z(y0), n1 = along_z(x1), n2 = along_z(y1), n3 = -along_z(x0);
  const auto angle = [](Float a, Float b) { return acos(max(min(-(a * b), Float(1.f)), Float(-1.f))); };
  constexpr float turn = 6.28318530718f;
  const Float g01 = angle(n0, n1) + angle(n1, n2), k = Float(turn) - angle(n2, n3) - angle(n3, n0);
  const Float solid_angle = g01 - k;

  const SinCos phi = sincos_turn(max(min(fma(u, solid_angle, k) * Float(1 / turn), Float(1.f)), Float(0.f)));
  const Float f = fma(phi.cos, n0, -n2) / phi.sin;
  const Float cu = max(min(copy_sign(Float(1.f) / sqrt(fma(f, f, n0 * n0)), f), Float(1.f)), Float(-1.f));
  const Float x = min(max(-(cu * z) / sqrt(max(fma(-cu, cu, Float(1.f)), Float(0x1p-40f))), x0), x1);
  const Float d2 = fma(x, x, z2);
  const auto height = [&](Float y) { return y / sqrt(max(fma(y, y, d2), Float(0x1p-100f))); };
  const Float h = fma(height(y1) - height(y0), v, height(y0));
  const Float y = min(max(h * sqrt(d2) / sqrt(max(fma(-h, h, Float(1.f)), Float(0x1p-40f))), y0), y1);

  constexpr float least = 0.03f;
  const Float distance2 = fma(y, y, d2);
  return {(x - x0) / length1, (y - y0) / length2,
          solid_angle * distance2 * sqrt(distance2) / max(-z, Float(0x1p-100f)), solid_angle > Float(least)};
}

}  // namespace castray::CASTRAY_ISA
