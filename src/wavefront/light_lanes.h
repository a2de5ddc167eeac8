#pragma once

#include "lights/light_share_lanes.h"
#include "wavefront/absorption_lanes.h"
#include "wavefront/guided_lanes.h"
#include "wavefront/light_points_lanes.h"
#include "wavefront/shading_lanes.h"

namespace castray::CASTRAY_ISA {

/// The pdf, per area of the light, with which light sampling at p finds the point in direction wi, for MIS.
CASTRAY_INLINE Float light_density(const LightList& lights, const LightPoint& point, const Vec& p,
                                   const Vec& wi) {
  if (!lights.regions.tree) return point.density;
  const Float relative = relative_density(lights.regions, p, wi, point.node);
  return select(point.infinite, point.density, point.density * relative);
}

/// A light point for each vertex, which is number `vertex` of its path, as a shadow ray with its MIS-weighted
/// radiance. `point_of(i)`: those of vertices i to i + width - 1.
template <class Geometry, uint32_t features, class PointOf>
CASTRAY_INLINE void shadow_rays(const Context& c, const Vertices& vertices, uint32_t vertex, PointOf point_of,
                                ShadowRays& out) {
  out.count = 0;
  const LightList& lights = c.scene.lights;
  for (int i = 0; i < vertices.count; i += width) {
    if constexpr (features & feature_materials)
      if (none(first_lanes(vertices.count - i) & ~has_traits(c.scene, records_of(vertices, i), trait_smooth)))
        continue;
    const LightPoint point = point_of(i);
    const LightSegment segment = connect_light(point, load(vertices.p, i));
    const Vec wi = segment.towards * segment.inverse_distance;
    Vec p = load(vertices.p, i), normal = load(vertices.normal, i), f_cos;
    Float pdf(0.f);
    if constexpr (features & feature_materials) {
      const Shading shading = shading_of<features>(c.scene, vertices, i);
      const Vec local = to_local(shading.frame, wi);
      const BsdfValue value = evaluate(shading.bsdf, shading.wo, local);
      f_cos = select(shading.consistent(wi, local), value.f_cos, black());
      pdf = pdf_with_guide(c, vertices, i, guided_at(c, vertices, i, vertex), wi, value.pdf);
      p = leave(vertices, i, wi);
      normal = normal_towards(vertices, i, wi);
    } else {
      pdf = max(dot(normal, wi), Float(0.f)) * Float(1.f / pi);
      f_cos = load_kd(vertices.parameters, i) * pdf;
    }
    Float share(1.f);
    if (c.options.mis) share = light_share(light_density(lights, point, p, wi), pdf * segment.solid_angle);
    Vec radiance = load(vertices.throughput, i) * f_cos * point.weight * (segment.solid_angle * share);
    if constexpr (features & feature_materials)
      if (c.scene.absorbing)
        radiance = radiance * transmittance(c.scene, media_towards(c.scene, vertices, i, wi), point, segment);
    const Mask lit = first_lanes(vertices.count - i) & ~(max_component(radiance) <= Float(0.f));
    const int n = out.count;
    const Segment traced = to_trace(geometry_of<Geometry>(c), lights, segment, p, normal);
    compress_store(out.o, n, lit, traced.o);
    compress_store(out.d, n, lit, traced.d);
    compress_store(out.radiance, n, lit, radiance);
    compress_store(out.slot + n, lit, load(vertices.names.slot + i));
    out.count += count(lit);
  }
}

/// Light sampling: a point of one light for each vertex.
template <class Geometry, uint32_t features>
CASTRAY_STAGE void light(const Context& c, const Vertices& vertices, uint32_t vertex, ShadowRays& out) {
  const auto point_of = [&](int i) {
    LightPoint point = vertex_light_points(c, vertices, i, vertex, !(features & feature_materials));
    if constexpr (features & feature_materials)
      if (vertex > 0) point.weight = select(leaves_lamps(c, vertices, i), black(), point.weight);
    return point;
  };
  shadow_rays<Geometry, features>(c, vertices, vertex, point_of, out);
}

/// Light sampling: a direction to the environment for each vertex.
template <class Geometry, uint32_t features>
CASTRAY_STAGE void light_environment(const Context& c, const Vertices& vertices, uint32_t vertex,
                                     ShadowRays& out) {
  shadow_rays<Geometry, features>(
      c, vertices, vertex, [&](int i) { return vertex_environment_points(c, vertices, i, vertex); }, out);
}

/// Light sampling: a light without size for each vertex that is on a surface.
template <class Geometry, uint32_t features>
CASTRAY_STAGE void light_deltas(const Context& c, const Vertices& vertices, uint32_t vertex,
                                ShadowRays& out) {
  shadow_rays<Geometry, features>(
      c, vertices, vertex, [&](int i) { return vertex_delta_lights(c, vertices, i, vertex); }, out);
}

}  // namespace castray::CASTRAY_ISA
