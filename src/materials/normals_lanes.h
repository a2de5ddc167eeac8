#pragma once

#include "geometry/placement_lanes.h"
#include "materials/surface_values_lanes.h"

// Shading normals: of vertices, and as normal and bump maps bend them (materials/bent_normal.h).

namespace castray::CASTRAY_ISA {

/// The interpolated vertex normal, on the side of `facing` (the geometric normal on the viewer's side);
/// `facing` itself where there is none or where the viewer would be behind it.
template <class Placement>
CASTRAY_INLINE Vec smooth_normal(const TriangleTable& table, const Placement& placement,
                                 const TrianglePlace& at, const Vec& facing, const Vec& to_viewer) {
  if (!table.normal_corners) return facing;
  Corners corners = corners_of(table.normal_corners, at.triangle);
  const Mask none = corners.a == Uint(no_corner);
  const auto normal = [&](Uint i) {
    return placement.vertex_normal(gather_vec(table.normals, select(none, Uint(0u), i) * 3u));
  };
  Vec n = normal(corners.a) * (Float(1.f) - at.b1 - at.b2) + normal(corners.b) * at.b1 +
          normal(corners.c) * at.b2;
  n = normalize(n);
  n = select(dot(n, facing) < Float(0.f), -n, n);
  const Mask usable = ~none & (dot(n, to_viewer) > Float(0.f)) & (length_squared(n) > Float(0.f));
  return select(usable, n, facing);
}

/// How the points of triangles move with their texture coordinates; see UvDerivatives.
struct UvDerivatives {
  Vec du, dv;
  Float handedness;
  Mask valid;
};
template <class Placement>
CASTRAY_INLINE UvDerivatives uv_derivatives(const TriangleTable& table, const Placement& placement,
                                            Uint triangle) {
  const Corners p = corners_of(table.corners, triangle), t = corners_of(table.uv_corners, triangle);
  const Mask there = ~(t.a == Uint(no_corner));
  const auto position = [&](Uint i) { return gather_vec(table.positions, i * 3u); };
  const Vec p0 = position(p.a), e1 = placement.direction(position(p.b) - p0),
            e2 = placement.direction(position(p.c) - p0);
  const auto uv = [&](Uint i, uint32_t axis) {
    return gather(table.uvs, select(there, i, Uint(0u)) * 2u + axis);
  };
  const Float u0 = uv(t.a, 0), v0 = uv(t.a, 1);
  const Float u1 = uv(t.b, 0) - u0, v1 = uv(t.b, 1) - v0, u2 = uv(t.c, 0) - u0, v2 = uv(t.c, 1) - v0;
  const Float determinant = u1 * v2 - v1 * u2, inverse = Float(1.f) / determinant;
  const Vec du = (e1 * v2 - e2 * v1) * inverse, dv = (e2 * u1 - e1 * u2) * inverse;
  const Float infinity(__builtin_inff());
  const Mask finite = (max_component(magnitude(du)) < infinity) & (max_component(magnitude(dv)) < infinity);
  return {du, dv, placement.handedness(copy_sign(Float(1.f), determinant)),
          there & (abs(determinant) > Float(0.f)) & finite};
}

/// Bends the normals n, on the viewer's side as `facing` is, of the lanes whose materials say so. `front`:
/// that is the geometric normal's side.
template <class Placement>
__attribute__((noinline)) void bend_normals(const MaterialTables& tables, const TriangleTable& table,
                                            const Placement& placement, const Uint& material,
                                            const TrianglePlace& at, const Mask& front, const Vec& facing,
                                            const Vec& to_viewer, Vec& n) {
  if (!table.uv_corners) return;
  const Mask bent = has_traits(tables, material, trait_bent);
  if (none(bent)) return;
  const MapInputs in = map_inputs(table, at);
  const UvDerivatives d = uv_derivatives(table, placement, at.triangle);
  const auto across = [](const Vec& normal, const Vec& w) { return w - normal * dot(normal, w); };
  const Vec start = select(front, n, -n);  // on the geometric normal's side
  for_each_detail(tables, material, bent & d.valid, [&](const KernelDetail& detail, Mask here) {
    Vec m = start;
    if (detail.normal) {
      const Vec tangent = normalize(across(m, d.du)), bitangent = cross(m, tangent) * d.handedness;
      const Vec local = map_normal(*detail.normal, in.u, in.v);
      m = normalize(tangent * local.x + bitangent * local.y + m * local.z);
    }
    if (detail.bump) {
      const Gradient h = map_gradient(*detail.bump, in.u, in.v);
      m = normalize(cross(across(m, d.du) + m * h.u, across(m, d.dv) + m * h.v)) * d.handedness;
    }
    m = select(front, m, -m);
    const Mask usable = here & d.valid & (dot(m, to_viewer) > Float(0.f)) & (dot(m, facing) > Float(0.f));
    n = select(usable, m, n);
  });
}

}  // namespace castray::CASTRAY_ISA
