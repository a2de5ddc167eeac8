#pragma once

#include "kernels/lights.h"
#include "kernels/list.h"
#include "kernels/wave.h"

// The stages that a batch of paths goes through, each from arrays to arrays:
//
//   camera_rays -> Paths -> closest -> Hits -> surfaces -> Vertices -> light -> ShadowRays -> add_unblocked
//                    ^                                        |
//                    +------------------- scatter <-----------+

namespace castray::CASTRAY_ISA {

inline constexpr float pi = 3.14159265358979f;

/// The random numbers' block for a path vertex; the same as PathBlocks of core/sequences.h.
constexpr uint32_t direction_block(uint32_t vertex) { return 1 + 2 * vertex; }
constexpr uint32_t choice_block(uint32_t vertex) { return 2 + 2 * vertex; }

struct Context {
  const KernelScene& scene;
  const KernelOptions& options;
  const TileJob& job;
  uint64_t rays = 0;
};

CASTRAY_INLINE uint32_t hash_once(uint32_t a, uint32_t b) { return lane(hash_combine(Uint(a), Uint(b)), 0); }

/// The key's part that stands for the epoch of the sample index (see sample_block).
CASTRAY_INLINE Uint with_epoch(Uint key, uint64_t sample) {
  const uint32_t epoch = (uint32_t)(sample >> index_bits);
  return epoch ? hash_combine(key, Uint(~epoch)) : key;
}

/// One ray for each pixel of the job, slot = its number.
CASTRAY_INLINE void camera_rays(const Context& c, Paths& paths) {
  const KernelCamera& camera = c.scene.camera;
  const uint32_t index = (uint32_t)c.job.sample & ((1u << index_bits) - 1);
  paths.count = c.job.tiles * tile_pixels;
  for (int i = 0; i < paths.count; i += width) {
    const Uint entry = Uint((uint32_t)i) + lane_index();
    const Uint x = Uint((uint32_t)c.job.x) + ((entry >> 6) << 3) + (entry & 7u);
    const Uint y = Uint((uint32_t)c.job.y) + ((entry >> 3) & 7u);
    const Uint key = with_epoch(hash_combine(hash_combine(Uint(c.options.seed), x), y), c.job.sample);
    const Numbers<4> n = draw<4>(c.options.sobol, {key, Uint(index)}, 0);
    const Float px = to_float(x) + (c.options.jitter ? n.u[0] : Float(0.5f));
    const Float py = to_float(y) + (c.options.jitter ? n.u[1] : Float(0.5f));
    store(paths.o, i, broadcast(camera.position));
    store(paths.d, i, fma(broadcast(camera.dx), px, fma(broadcast(camera.dy), py, broadcast(camera.corner))));
    store(paths.throughput, i, Vec{Float(1.f), Float(1.f), Float(1.f)});
    store(paths.light_u + i, n.u[2]);
    store(paths.light_v + i, n.u[3]);
    store(paths.slot + i, entry);
    store(paths.key + i, key);
    store(paths.index + i, Uint(index));
  }
}

CASTRAY_INLINE void closest(Context& c, const Paths& paths, bool from_camera, Hits& hits) {
  const Float slack(from_camera ? c.scene.camera_slack : c.scene.slack);
  for (int i = 0; i < paths.count; i += width) {
    const ListHit hit = list_closest(c.scene.facets, load(paths.o, i), load(paths.d, i), slack);
    store(hits.t + i, hit.t);
    store(hits.primitive + i, hit.facet);
  }
  c.rays += (uint64_t)paths.count;
}

/// What a path that arrives from the camera, or from a perfectly specular bounce, sees of the surface's own
/// light.
CASTRAY_INLINE Vec seen_emission(const KernelMaterial& first, Uint material, Mask front) {
  const Mask shines = front | (gather(&first.two_sided, material) == Uint(1u));
  const Vec dark{Float(0.f), Float(0.f), Float(0.f)};
  return select(shines, gather_vec(first.emission, material), dark);
}

/// The surface at each hit. Paths that miss collect the environment and end; `see_emission`: light sources are added.
/// With `keep_misses` every path keeps its place, and a miss is a black vertex without a normal.
template <bool keep_misses>
CASTRAY_INLINE void surfaces(const Context& c, const Paths& paths, const Hits& hits, bool see_emission,
                             Vertices& out, Radiance& radiance) {
  const Facet& facet = *c.scene.facets.facets;
  const KernelMaterial& materials = *c.scene.materials;
  out.count = 0;
  for (int i = 0; i < paths.count; i += width) {
    const Mask active = first_lanes(paths.count - i);
    const Uint primitive = load(hits.primitive + i);
    const Mask hit = active & ~(primitive == Uint(no_hit));
    const Uint record = select(hit, primitive, Uint(0u)) * uint32_t{facet_floats};
    const Vec o = load(paths.o, i), d = load(paths.d, i);
    const Vec throughput = load(paths.throughput, i);
    const Vec normal = gather_vec(facet.normal, record);
    const Vec on_ray = fma(d, load(hits.t + i), o);
    const Float above = dot(normal, on_ray) - gather(&facet.offset, record);
    const Float towards = dot(normal, d);
    const Vec facing{flip_by_sign(normal.x, -towards), flip_by_sign(normal.y, -towards),
                     flip_by_sign(normal.z, -towards)};
    const Vec p = fma(facing, gather(&facet.error, record), fma(normal, -above, on_ray));
    const Uint material = gather(&facet.material, record) * uint32_t{material_floats};
    if (see_emission)
      radiance.add(paths.slot + i, hit,
                   throughput * seen_emission(materials, material, towards < Float(0.f)));
    radiance.add(paths.slot + i, active & ~hit, throughput * broadcast(c.scene.environment));
    const Mask kept = keep_misses ? active : hit;
    const Vec none{Float(0.f), Float(0.f), Float(0.f)};
    const Vec albedo = gather_vec(materials.kd, material);
    const int n = out.count;
    compress_store(out.p, n, kept, p);
    compress_store(out.normal, n, kept, keep_misses ? select(hit, facing, none) : facing);
    compress_store(out.albedo, n, kept, keep_misses ? select(hit, albedo, none) : albedo);
    compress_store(out.throughput, n, kept, throughput);
    compress_store(out.light_u + n, kept, load(paths.light_u + i));
    compress_store(out.light_v + n, kept, load(paths.light_v + i));
    compress_store(out.slot + n, kept, load(paths.slot + i));
    compress_store(out.key + n, kept, load(paths.key + i));
    compress_store(out.index + n, kept, load(paths.index + i));
    out.count += count(kept);
  }
}

/// One light point for each vertex.
CASTRAY_INLINE void light(const Context& c, const Vertices& vertices, uint32_t vertex, ShadowRays& out) {
  out.count = 0;
  if (c.scene.lights.count == 0) return;
  for (int i = 0; i < vertices.count; i += width) {
    const Sequence sequence = load_sequence(vertices.key, vertices.index, i);
    const Float choice =
        c.scene.lights.count > 1 ? draw<3>(c.options.sobol, sequence, choice_block(vertex)).u[2] : Float(0.f);
    const LightPoint point =
        sample_light(c.scene.lights, choice, load(vertices.light_u + i), load(vertices.light_v + i));
    const Vec p = load(vertices.p, i);
    const LightSegment segment = connect_light(point, p, load(vertices.normal, i));
    const Mask lit = first_lanes(vertices.count - i) & (segment.geometry > Float(0.f));
    const Vec reflected =
        load(vertices.throughput, i) * load(vertices.albedo, i) * (segment.geometry * Float(1.f / pi));
    const int n = out.count;
    compress_store(out.o, n, lit, p);
    compress_store(out.d, n, lit, segment.d);
    compress_store(out.radiance, n, lit, reflected * point.weight);
    compress_store(out.slot + n, lit, load(vertices.slot + i));
    out.count += count(lit);
  }
}

CASTRAY_INLINE void add_unblocked(Context& c, const ShadowRays& rays, Radiance& radiance) {
  for (int i = 0; i < rays.count; i += width) {
    const Mask blocked =
        list_occluded(c.scene.blockers, load(rays.o, i), load(rays.d, i), Float(c.scene.slack));
    radiance.add(rays.slot + i, first_lanes(rays.count - i) & ~blocked, load(rays.radiance, i));
  }
  c.rays += (uint64_t)rays.count;
}

/// Survival probability of a path about to leave `vertex`.
CASTRAY_INLINE Float survival(const KernelOptions& options, uint32_t vertex, uint32_t first_roulette,
                              Vec throughput) {
  if (options.fixed_roulette) return Float(options.survival);
  return vertex < first_roulette ? Float(1.f) : min(max_component(throughput), Float(0.95f));
}

/// A direction about the normal with density cos / pi (Malley's method).
CASTRAY_INLINE Vec cosine_direction(const Vec& normal, Float u, Float v) {
  const SinCos turn = sincos_turn(v);
  const Float r = sqrt(u);
  return to_world(make_frame(normal), {r * turn.cos, r * turn.sin, sqrt(max(Float(1.f) - u, Float(0.f)))});
}

/// The next ray of each path that survives the roulette.
CASTRAY_INLINE void scatter(const Context& c, const Vertices& vertices, uint32_t vertex,
                            uint32_t first_roulette, Paths& out) {
  out.count = 0;
  const bool roulette = c.options.fixed_roulette || vertex >= first_roulette;
  for (int i = 0; i < vertices.count; i += width) {
    const Sequence sequence = load_sequence(vertices.key, vertices.index, i);
    const Numbers<4> n = draw<4>(c.options.sobol, sequence, direction_block(vertex));
    Vec throughput = load(vertices.throughput, i) * load(vertices.albedo, i);
    Mask alive = first_lanes(vertices.count - i) & (max_component(throughput) > Float(0.f));
    if (roulette) {
      const Float p = survival(c.options, vertex, first_roulette, throughput);
      alive = alive & (draw<1>(c.options.sobol, sequence, choice_block(vertex)).u[0] < p);
      throughput = throughput * (Float(1.f) / p);
    }
    const int k = out.count;
    compress_store(out.o, k, alive, load(vertices.p, i));
    compress_store(out.d, k, alive, cosine_direction(load(vertices.normal, i), n.u[0], n.u[1]));
    compress_store(out.throughput, k, alive, throughput);
    compress_store(out.light_u + k, alive, n.u[2]);
    compress_store(out.light_v + k, alive, n.u[3]);
    compress_store(out.slot + k, alive, load(vertices.slot + i));
    compress_store(out.key + k, alive, sequence.key);
    compress_store(out.index + k, alive, sequence.index);
    out.count += count(alive);
  }
}

}  // namespace castray::CASTRAY_ISA
