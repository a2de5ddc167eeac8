#pragma once

#include "geometry/facet_list_lanes.h"
#include "geometry/wide_bvh_lanes.h"
#include "materials/ggx_lanes.h"
#include "wavefront/wave_lanes.h"

// What depends on how the scene's triangles are held: a flat list of facets, or a tree.

namespace castray::CASTRAY_ISA {

/// Far ends of rays and of segments.
struct FarEnds {
  alignas(64) FloatArray infinite, one;
};
CASTRAY_INLINE void fill(FarEnds& ends) {
  for (int i = 0; i < capacity; ++i) {
    ends.infinite[i] = __builtin_inff();
    ends.one[i] = 1;
  }
}

template <uint32_t features>
CASTRAY_INLINE void closest(Context& c, const Paths& paths, const FarEnds& ends, bool from_camera,
                            Hits& hits) {
  c.rays += (uint64_t)paths.count;
  if constexpr (features & feature_bvh) {
    bvh_closest(c.scene.bvh, {paths.o.x, paths.o.y, paths.o.z, paths.d.x, paths.d.y, paths.d.z, ends.infinite,
                              hits.t, hits.primitive, hits.b1, hits.b2, (uint32_t)paths.count});
  } else {
    const Float slack(from_camera ? c.scene.camera_slack : list_slack);
    for (int i = 0; i < paths.count; i += width) {
      const ListHit hit = list_closest(c.scene.facets, load(paths.o, i), load(paths.d, i), slack);
      store(hits.t + i, hit.t);
      store(hits.primitive + i, hit.facet);
    }
  }
}

/// Adds the radiance of the segments that nothing blocks.
template <uint32_t features>
CASTRAY_INLINE void add_unblocked(Context& c, const FarEnds& ends, ShadowRays& rays, Radiance& radiance) {
  c.rays += (uint64_t)rays.count;
  if constexpr (features & feature_bvh) {
    bvh_occluded(c.scene.bvh, {rays.o.x, rays.o.y, rays.o.z, rays.d.x, rays.d.y, rays.d.z, ends.one,
                               rays.blocked, (uint32_t)rays.count});
    for (int i = 0; i < rays.count; ++i) {
      if (rays.blocked[i]) continue;
      radiance.x[rays.slot[i]] += rays.radiance.x[i];
      radiance.y[rays.slot[i]] += rays.radiance.y[i];
      radiance.z[rays.slot[i]] += rays.radiance.z[i];
    }
  } else {
    const Float slack(segment_slack);
    for (int i = 0; i < rays.count; i += width) {
      const Mask blocked = list_occluded(c.scene.blockers, load(rays.o, i), load(rays.d, i), slack);
      radiance.add(rays.slot + i, first_lanes(rays.count - i) & ~blocked, load(rays.radiance, i));
    }
  }
}

/// A hit point: `p` on the surface, `normal` as the winding has it, `error` the bound of p's distance from
/// the surface, `material` the offset of its record in floats.
struct HitPoint {
  Vec p, normal;
  Float error;
  Uint material;
};

/// The corners of triangles in a table of vertices.
struct Corners {
  Uint a, b, c;
};
CASTRAY_INLINE Corners corners_of(const uint32_t* table, Uint triangle) {
  const Uint first = triangle * 3u;
  return {gather(table, first), gather(table, first + 1u), gather(table, first + 2u)};
}

CASTRAY_INLINE HitPoint facet_point(const KernelScene& scene, const Vec& o, const Vec& d, Float t,
                                    Uint primitive) {
  const Facet& facet = *scene.facets.facets;
  const Uint record = primitive * uint32_t{facet_floats};
  const Vec normal = gather_vec(facet.normal, record);
  const Vec on_ray = fma(d, t, o);
  const Float above = dot(normal, on_ray) - gather(&facet.offset, record);
  return {fma(normal, -above, on_ray), normal, gather(&facet.error, record),
          gather(&facet.material, record) * uint32_t{material_floats}};
}

/// Error along `normal` that a ray/triangle test adds where the triangle reaches `distance`, the greatest of
/// its coordinates, from the ray's origin (error_of_test in core/error_bounds.h).
CASTRAY_INLINE Float error_of_test(Float distance, const Vec& normal) {
  return distance * sum_abs(normal) * Float(24 * 0x1p-24f);
}

/// The far end of a segment that begins at `from`: p, which is off its surface by its own error to the side
/// of `normal`, moved on by the error of a test from so far. A facet's error has that in it.
template <uint32_t features>
CASTRAY_INLINE Vec far_end(const Vec& p, const Vec& normal, const Vec& from) {
  if constexpr (!(features & feature_bvh)) return p;
  return fma(normal, error_of_test(max_component(magnitude(p - from)), normal), p);
}

/// The point from its barycentrics. The error of each coordinate is at most gamma(7) times the sum of the
/// terms' magnitudes, and one rounding more for the step along the normal; the ray/triangle test adds its
/// own, without which triangles in the plane of an axis would shadow themselves.
CASTRAY_INLINE HitPoint triangle_point(const KernelScene& scene, Float b1, Float b2, Uint primitive) {
  const TriangleTable& table = scene.triangles;
  const Corners corners = corners_of(table.corners, primitive);
  const Vec v0 = gather_vec(table.positions, corners.a * 3u),
            v1 = gather_vec(table.positions, corners.b * 3u),
            v2 = gather_vec(table.positions, corners.c * 3u);
  const Vec e1 = v1 - v0, e2 = v2 - v0;
  const Vec normal = normalize(
      Vec{fma(e1.y, e2.z, -(e1.z * e2.y)), fma(e1.z, e2.x, -(e1.x * e2.z)), fma(e1.x, e2.y, -(e1.y * e2.x))});
  const Float b0 = Float(1.f) - b1 - b2;
  const Vec p0 = v0 * b0, p1 = v1 * b1, p2 = v2 * b2;
  const Vec size = magnitude(p0) + magnitude(p1) + magnitude(p2);
  const Float extent = max(max_component(magnitude(e1)), max_component(magnitude(e2)));
  const Float error = fma(dot(magnitude(normal), size), Float(9 * 0x1p-24f), error_of_test(extent, normal));
  const Uint word = gather(table.materials, primitive >> 1);
  const Uint id = select((primitive & 1u) == Uint(1u), word >> 16, word & 0xffffu);
  return {p0 + p1 + p2, normal, error, id * uint32_t{material_floats}};
}

template <uint32_t features>
CASTRAY_INLINE HitPoint hit_point(const KernelScene& scene, const Vec& o, const Vec& d, const Hits& hits,
                                  int i, Uint primitive) {
  if constexpr (features & feature_bvh)
    return triangle_point(scene, load(hits.b1 + i), load(hits.b2 + i), primitive);
  return facet_point(scene, o, d, load(hits.t + i), primitive);
}

}  // namespace castray::CASTRAY_ISA
