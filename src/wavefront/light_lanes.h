#pragma once

#include "lights/area_lights_lanes.h"
#include "wavefront/context_lanes.h"
#include "wavefront/sequence_keys_lanes.h"
#include "wavefront/shading_lanes.h"

namespace castray::CASTRAY_ISA {

/// A light point for each of the vertices i to i + width - 1, which are number `vertex` of their paths.
template <uint32_t features>
CASTRAY_INLINE LightPoint vertex_light_point(const Context& c, const Vertices& vertices, int i,
                                             uint32_t vertex) {
  Numbers<4> n{{Float(0.f), Float(0.f), Float(0.f), Float(0.f)}};
  if (c.scene.lights.count > 1)
    n = draw<4>(c.options.sobol, sequence_of(vertices.names, i), choice_block(vertex));
  Mask one_sided(true);
  if constexpr (features & feature_materials)
    one_sided = ~has_traits(c.scene, load(vertices.material + i) & 0x7fffffffu, trait_transmits);
  const Receiver receiver = receiving_point(load(vertices.p, i), load(vertices.normal, i), one_sided);
  return sample_light(c.scene.lights, receiver, n.u[2], n.u[3], load(vertices.names.light_u + i),
                      load(vertices.names.light_v + i));
}

/// One light point for each vertex.
template <uint32_t features>
CASTRAY_INLINE void light(const Context& c, const Vertices& vertices, uint32_t vertex, ShadowRays& out) {
  out.count = 0;
  const LightList& lights = c.scene.lights;
  if (lights.count == 0) return;
  for (int i = 0; i < vertices.count; i += width) {
    const LightPoint point = vertex_light_point<features>(c, vertices, i, vertex);
    const LightSegment segment = connect_light(point, load(vertices.p, i));
    const Vec wi = segment.towards * segment.inverse_distance;
    Vec p = load(vertices.p, i), normal = load(vertices.normal, i), f_cos;
    Float pdf(0.f);
    if constexpr (features & feature_materials) {
      const Shading shading = shading_of<features>(c.scene, vertices, i);
      const Vec local = to_local(shading.frame, wi);
      const BsdfValue value = evaluate(shading.bsdf, shading.wo, local);
      f_cos = select(shading.consistent(wi, local), value.f_cos, black());
      pdf = value.pdf;
      p = leave(vertices, i, wi);
      normal = normal_towards(vertices, i, wi);
    } else {
      pdf = max(dot(normal, wi), Float(0.f)) * Float(1.f / pi);
      f_cos = load_kd(vertices.parameters, i) * pdf;
    }
    const Float share = c.options.mis
                            ? point.density / max(point.density + pdf * segment.solid_angle, Float(0x1p-100f))
                            : Float(1.f);
    const Vec radiance = load(vertices.throughput, i) * f_cos * point.weight * (segment.solid_angle * share);
    const Mask lit = first_lanes(vertices.count - i) & ~(max_component(radiance) <= Float(0.f));
    const int n = out.count;
    const Segment traced = to_trace<features>(lights, segment, p, normal);
    compress_store(out.o, n, lit, traced.o);
    compress_store(out.d, n, lit, traced.d);
    compress_store(out.radiance, n, lit, radiance);
    compress_store(out.slot + n, lit, load(vertices.names.slot + i));
    out.count += count(lit);
  }
}

}  // namespace castray::CASTRAY_ISA
