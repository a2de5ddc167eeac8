#pragma once

#include "geometry/geometry_records.h"
#include "geometry/surface_point_lanes.h"

// Points on the triangles of a TriangleTable.

namespace castray::CASTRAY_ISA {

/// Indices of the corners of triangles into a table of vertices, normals or texture coordinates.
struct Corners {
  Uint a, b, c;
};
CASTRAY_INLINE Corners corners_of(const uint32_t* table, Uint triangle) {
  const Uint first = triangle * 3u;
  return {gather(table, first), gather(table, first + 1u), gather(table, first + 2u)};
}

/// Error along `normal` of a ray/triangle test where the triangle's coordinates reach `distance` from the
/// ray's origin (error_of_test in core/error_bounds.h).
CASTRAY_INLINE Float error_of_test(Float distance, const Vec& normal) {
  return distance * sum_abs(normal) * Float(24 * 0x1p-24f);
}

CASTRAY_INLINE Uint material_of(const TriangleTable& table, Uint triangle) {
  const Uint word = gather(table.materials, triangle >> 1);
  return select((triangle & 1u) == Uint(1u), word >> 16, word & 0xffffu);
}

/// What a hit's triangle is like in its own space: the point, a normal of any length, the sum of the
/// magnitudes of the point's terms, and the greatest coordinate of an edge.
struct TriangleShape {
  Vec p, normal, size;
  Float extent;
};
CASTRAY_INLINE TriangleShape triangle_shape(const TriangleTable& table, const SurfaceHit& hit) {
  const Corners corners = corners_of(table.corners, hit.primitive);
  const Vec v0 = gather_vec(table.positions, corners.a * 3u),
            v1 = gather_vec(table.positions, corners.b * 3u),
            v2 = gather_vec(table.positions, corners.c * 3u);
  const Vec e1 = v1 - v0, e2 = v2 - v0;
  const Vec normal{fma(e1.y, e2.z, -(e1.z * e2.y)), fma(e1.z, e2.x, -(e1.x * e2.z)),
                   fma(e1.x, e2.y, -(e1.y * e2.x))};
  const Float b0 = Float(1.f) - hit.b1 - hit.b2;
  const Vec p0 = v0 * b0, p1 = v1 * hit.b1, p2 = v2 * hit.b2;
  return {p0 + p1 + p2, normal, magnitude(p0) + magnitude(p1) + magnitude(p2),
          max(max_component(magnitude(e1)), max_component(magnitude(e2)))};
}

/// The point at barycentrics b1, b2. The error of each coordinate is at most gamma(7) times the sum of the
/// terms' magnitudes, and one more rounding for the offset along the normal. The error of the ray/triangle
/// test is added, or triangles in an axis-aligned plane would shadow themselves.
CASTRAY_INLINE SurfacePoint triangle_point(const TriangleTable& table, const SurfaceHit& hit) {
  const TriangleShape shape = triangle_shape(table, hit);
  const Vec normal = normalize(shape.normal);
  const Float error =
      fma(dot(magnitude(normal), shape.size), Float(9 * 0x1p-24f), error_of_test(shape.extent, normal));
  return {shape.p, normal, error, material_of(table, hit.primitive)};
}

}  // namespace castray::CASTRAY_ISA
