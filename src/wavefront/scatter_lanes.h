#pragma once

#include "materials/stretch_lanes.h"
#include "wavefront/absorption_lanes.h"
#include "wavefront/guided_lanes.h"
#include "wavefront/light_normals_lanes.h"
#include "wavefront/sequence_keys_lanes.h"
#include "wavefront/shading_lanes.h"

namespace castray::CASTRAY_ISA {

enum class Transport : uint8_t {
  from_camera,
  from_light,
  from_light_caustic  ///< by specular lobes, and surfaces that focus, alone
};

/// Survival probability of paths at `vertex`. Even a fixed one is capped after many vertices, so that
/// every path ends. Light that is caught in glass for long has the weight of all that is not, and a cap
/// would make it brighter the longer it is caught; so it comes late: on paths from lights, whose caustics are
/// narrow, and where a scattering `focuses`.
CASTRAY_INLINE Float survival(const KernelOptions& options, uint32_t vertex, uint32_t first_roulette,
                              Float brightest, Mask focuses, Transport transport) {
  constexpr float highest = (float)highest_survival;
  if (options.fixed_roulette)
    return Float(vertex < first_capped_vertex || options.survival < highest ? options.survival : highest);
  constexpr uint32_t first_capped_late = 256;
  if (vertex < first_roulette) return Float(1.f);
  const Mask late = Mask(vertex < first_capped_late) & (focuses | Mask(transport != Transport::from_camera));
  return min(brightest, select(late, Float(1.f), Float(highest)));
}

/// Paths::arrival of the rays that vertices i to i + width - 1 send on with this pdf. `focuses`: by
/// scatterings that do. What the camera itself sees decides which caustics are left to light paths.
CASTRAY_INLINE Float arrival_for_mis(const Context& c, const Vertices& vertices, int i, uint32_t vertex,
                                     Mask focuses, const BsdfSample& s) {
  const Float arrival = select(s.specular, Float(counts_all), c.options.mis ? s.pdf : Float(0.f));
  if (!c.left_to_light_paths) return arrival;
  const Mask active = first_lanes(vertices.count - i);
  if (vertex > 0) {
    const Uint slot = select(active, load(vertices.names.slot + i), Uint(0u));
    const Mask left = focuses & (gather(c.left_to_light_paths, slot) == Uint(1u));
    return select(left, -arrival, arrival);
  }
  for (uint32_t seen = bits(focuses & active); seen; seen &= seen - 1)
    c.left_to_light_paths[vertices.names.slot[i + __builtin_ctz(seen)]] = 0;
  return arrival;
}

/// BSDF sampling and Russian roulette: the next ray of each path that survives. From lights, throughput over
/// eta2 is that of radiance, too.
template <uint32_t features>
CASTRAY_STAGE void scatter(const Context& c, const Vertices& vertices, uint32_t vertex,
                           uint32_t first_roulette, Paths& out,
                           Transport transport = Transport::from_camera) {
  out.count = 0;
  const bool roulette = c.options.fixed_roulette || vertex >= first_roulette;
  for (int i = 0; i < vertices.count; i += width) {
    const Sequence sequence = sequence_of(vertices.names, i);
    const Numbers<4> n = draw<4>(c.options.sobol, sequence, PathBlocks::direction(vertex));
    Vec throughput = load(vertices.throughput, i), o = load(vertices.p, i), wi;
    Float arrival(0.f), eta2(1.f), brightest;
    Mask focuses(false);
    Numbers<2> choice{{Float(0.f), Float(0.f)}};
    if (roulette || (features & feature_materials))
      choice = draw<2>(c.options.sobol, sequence, PathBlocks::choice(vertex));
    if constexpr (features & feature_materials) {
      const Vec wo = load(vertices.wo, i), kept = load(vertices.shading_normal, i);
      ScatteringNormal normal{kept, Mask(false), Float(1.f)};
      if constexpr (features & feature_detail)
        if (transport != Transport::from_camera)
          normal = choose_normal(kept, load(vertices.normal, i), wo, n.u[2]);
      Shading shading = shading_of<features>(c.scene, vertices, i, normal.n);
      if constexpr (features & feature_detail)
        if (transport != Transport::from_camera && c.scene.stretched)
          relay_lobes(normal.geometric, kept, normal.n, shading.normal, shading.bsdf);
      const BsdfSample s = transport == Transport::from_camera
                               ? sample_guided(c, vertices, i, vertex, shading, choice.u[1], n.u[0], n.u[1])
                               : sample(shading.bsdf, shading.wo, choice.u[1], n.u[0], n.u[1]);
      wi = to_world(shading.frame, s.wi);
      throughput = throughput * select(shading.consistent(wi, s.wi), s.weight, black());
      focuses = s.specular | has_traits(c.scene, records_of(vertices, i), trait_focuses);
      arrival = arrival_for_mis(c, vertices, i, vertex, focuses, s);
      if constexpr (features & feature_detail)
        if (transport != Transport::from_camera)
          throughput = throughput * shading_normal_factor(shading, normal, kept, wo, wi, s.wi);
      if (transport == Transport::from_light_caustic) throughput = select(focuses, throughput, black());
      eta2 = load(vertices.eta2 + i) * s.eta2;
      brightest = max_component(throughput) * eta2;
      o = leave(vertices, i, wi);
    } else {
      const Vec local = cosine_hemisphere(n.u[0], n.u[1]);
      wi = to_world(make_frame(load(vertices.normal, i)), local);
      throughput = throughput * load_kd(vertices.parameters, i);
      if (c.options.mis) arrival = local.z * Float(1.f / pi);
      brightest = max_component(throughput);
    }
    Mask alive = first_lanes(vertices.count - i) & ~(brightest <= Float(0.f));
    if (roulette) {
      const Float p = survival(c.options, vertex, first_roulette, brightest, focuses, transport);
      alive = alive & (choice.u[0] < p);
      throughput = throughput * (Float(1.f) / p);
    }
    const int k = out.count;
    compress_store(out.o, k, alive, o);
    compress_store(out.d, k, alive, wi);
    compress_store(out.throughput, k, alive, throughput);
    compress_store(out.arrival + k, alive, arrival);
    compress_store(out.eta2 + k, alive, eta2);
    if (c.scene.absorbing) compress_store(out.media + k, alive, media_towards(c.scene, vertices, i, wi));
    compress_entries(out.names, k, alive, vertices.names, i);
    compress_store(out.names.light_u + k, alive, n.u[2]);
    compress_store(out.names.light_v + k, alive, n.u[3]);
    out.count += count(alive);
  }
}

}  // namespace castray::CASTRAY_ISA
