#pragma once

#include "wavefront/light_lanes.h"
#include "wavefront/sequence_keys_lanes.h"
#include "wavefront/suffixes_lanes.h"
#include "wavefront/trace_lanes.h"

namespace castray::CASTRAY_ISA {

/// A light point for each glossy suffix, as a shadow ray. The radiance arrives at y, in slots `offset` after
/// those of the suffixes; each pixel applies the BSDF of y, and the MIS weight, itself. `point_of(i)`: those
/// of vertices i to i + width - 1.
template <class Geometry, class PointOf>
CASTRAY_INLINE void shadow_rays_of_glossy(const Context& c, const Vertices& y, PointOf point_of,
                                          uint32_t offset, LightDirections& directions, ShadowRays& out) {
  out.count = 0;
  const LightList& lights = c.scene.lights;
  for (int i = 0; i < y.count; i += width) {
    const Mask active = first_lanes(y.count - i);
    const LightPoint point = point_of(i);
    const Vec p = load(y.p, i), normal = load(y.normal, i);
    const LightSegment segment = connect_light(point, p);
    const Vec wi = segment.towards * segment.inverse_distance;
    const Mask lit = active & (segment.solid_angle > Float(0.f)) & (dot(normal, wi) > Float(0.f)) &
                     (dot(load(y.shading_normal, i), wi) > Float(0.f));
    const int n = out.count;
    const Segment traced = to_trace(geometry_of<Geometry>(c), lights, segment, p, normal);
    compress_store(out.o, n, lit, traced.o);
    compress_store(out.d, n, lit, traced.d);
    Vec radiance = point.weight * segment.solid_angle;
    if (c.scene.absorbing)
      radiance = radiance * transmittance(c.scene, media_towards(c.scene, y, i, wi), point, segment);
    compress_store(out.radiance, n, lit, radiance);
    compress_store(out.slot + n, lit, load(y.names.slot + i) + Uint(offset));
    out.count += count(lit);
    keep_of_suffixes(directions.w, y, i, wi);
    keep_of_suffixes(directions.pdf, y, i, light_density(lights, point, p, wi) / segment.solid_angle);
  }
}

/// Light samples for each glossy suffix: a point of one light, and a direction to the environment.
template <class Geometry>
CASTRAY_STAGE void light_glossy(Context& c, const Vertices& y, Suffixes& suffixes, ShadowRays& rays,
                                Radiance& radiance) {
  if (c.scene.lights.count > 0) {
    shadow_rays_of_glossy<Geometry>(
        c, y,
        [&](int i) {
          LightPoint point = vertex_light_points(c, y, i, 1, false);
          point.weight = select(leaves_lamps(c, y, i), black(), point.weight);
          return point;
        },
        batch_size, suffixes.to_light, rays);
    add_unblocked<Geometry>(c, rays, radiance);
  }
  if (c.scene.lights.environment.width > 0) {
    shadow_rays_of_glossy<Geometry>(
        c, y, [&](int i) { return vertex_environment_points(c, y, i, 1); }, 2 * batch_size, suffixes.to_sky,
        rays);
    add_unblocked<Geometry>(c, rays, radiance);
  }
}

/// The next ray of each glossy suffix, sampled with wo towards the suffix's own pixel. Emission that it finds
/// is kept apart, for MIS.
template <uint32_t features>
CASTRAY_STAGE void scatter_glossy(const Context& c, const Vertices& y, Suffixes& suffixes, Paths& out) {
  const Vec one{Float(1.f), Float(1.f), Float(1.f)};
  out.count = 0;
  for (int i = 0; i < y.count; i += width) {
    const Sequence sequence = sequence_of(y.names, i);
    const Numbers<4> n = draw<4>(c.options.sobol, sequence, PathBlocks::direction(1));
    const Numbers<2> choice = draw<2>(c.options.sobol, sequence, PathBlocks::choice(1));
    const Shading shading = shading_of<features>(c.scene, y, i);
    const BsdfSample s = sample(shading.bsdf, shading.wo, choice.u[1], n.u[0], n.u[1]);
    const Vec wi = to_world(shading.frame, s.wi);
    const Mask going =
        first_lanes(y.count - i) & shading.consistent(wi, s.wi) & ~(max_component(s.weight) <= Float(0.f));
    const int k = out.count;
    compress_store(out.o, k, going, load(y.p, i));
    compress_store(out.d, k, going, wi);
    compress_store(out.throughput, k, going, one);
    compress_store(out.arrival + k, going, Float(0.f));
    compress_store(out.eta2 + k, going, Float(1.f));
    if (c.scene.absorbing) compress_store(out.media + k, going, load(y.media + i));
    compress_entries(out.names, k, going, y.names, i);
    compress_store(out.names.light_u + k, going, n.u[2]);
    compress_store(out.names.light_v + k, going, n.u[3]);
    out.count += count(going);
    keep_of_suffixes(suffixes.onward.w, y, i, wi);
  }
}

}  // namespace castray::CASTRAY_ISA
