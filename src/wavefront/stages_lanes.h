#pragma once

#include "geometry/hit_point_lanes.h"
#include "lights/area_lights_lanes.h"
#include "materials/bsdf_lanes.h"
#include "materials/texture_lanes.h"

// The stages that a batch of paths goes through, each from arrays to arrays:
//
//   camera_rays -> Paths -> closest -> Hits -> surfaces -> Vertices -> light -> ShadowRays -> add_unblocked
//                    ^                                        |
//                    +------------------- scatter <-----------+

namespace castray::CASTRAY_ISA {

/// The random numbers' block for a path vertex; the same as PathBlocks of core/sequences.h.
constexpr uint32_t direction_block(uint32_t vertex) { return 1 + 2 * vertex; }
constexpr uint32_t choice_block(uint32_t vertex) { return 2 + 2 * vertex; }

/// The key's part that stands for the epoch of the sample index (see sample_block).
CASTRAY_INLINE Uint with_epoch(Uint key, uint64_t sample) {
  const uint32_t epoch = (uint32_t)(sample >> index_bits);
  return epoch ? hash_combine(key, Uint(~epoch)) : key;
}

/// Mirrors place `at` of a grid of tiles across the nearer edge of its tile, by chance: half of the pixels
/// next to an edge, fewer and fewer further in. The same for both pixels of a pair, so that each pixel is in
/// one tile.
CASTRAY_INLINE Uint swap_across_edge(uint32_t key, Uint at, Uint along) {
  const Uint place = at & (tile_size - 1u), half(tile_size / 2u);
  const Mask low = place < half;
  const Uint steps = select(low, place, Uint(tile_size - 1u) - place);
  const Uint edge = select(low, at - place, at - place + Uint(tile_size));
  const Uint mirrored = select(low, edge - steps - 1u, edge + steps);
  const Float chance = Float(0.5f) - (to_float(steps) + Float(0.5f)) * Float(1.f / tile_size);
  const Uint dice = hash_combine(hash_combine(Uint(key), edge + steps), along);
  return select(to_float(dice >> 8) * Float(0x1p-24f) < chance, mirrored, at);
}

/// Where the pixels of the job lie. The first samples' tiles have ragged edges: sharing over straight ones
/// would show.
CASTRAY_INLINE void place_pixels(const Context& c, TileResult& result) {
  const bool ragged = c.job.sample < c.options.ragged;
  const uint32_t key = lane(hash_combine(Uint(c.options.seed ^ 0x3a99edu), Uint((uint32_t)c.job.sample)), 0);
  const Uint left((uint32_t)(c.job.grid_x * tile_size)), top((uint32_t)(c.job.grid_y * tile_size));
  for (int i = 0; i < c.job.tiles * tile_pixels; i += width) {
    const Uint entry = Uint((uint32_t)i) + lane_index();
    Uint x = left + ((entry >> 6) << 3) + (entry & 7u), y = top + ((entry >> 3) & 7u);
    if (ragged) {
      x = swap_across_edge(key, x, y);
      y = swap_across_edge(key + 1, y, x);
    }
    store(result.x + i, x - left + Uint((uint32_t)c.job.x));
    store(result.y + i, y - top + Uint((uint32_t)c.job.y));
  }
}

/// One ray for each pixel of the job, slot = its number.
CASTRAY_INLINE void camera_rays(const Context& c, const TileResult& pixels, Paths& paths) {
  const KernelCamera& camera = c.scene.camera;
  const uint32_t index = (uint32_t)c.job.sample & ((1u << index_bits) - 1);
  paths.count = c.job.tiles * tile_pixels;
  for (int i = 0; i < paths.count; i += width) {
    const Uint entry = Uint((uint32_t)i) + lane_index();
    const Uint x = load(pixels.x + i), y = load(pixels.y + i);
    const Uint key = with_epoch(hash_combine(hash_combine(Uint(c.options.seed), x), y), c.job.sample);
    const Numbers<4> n = draw<4>(c.options.sobol, {key, Uint(index)}, 0);
    const Float px = to_float(x) + (c.options.jitter ? n.u[0] : Float(0.5f));
    const Float py = to_float(y) + (c.options.jitter ? n.u[1] : Float(0.5f));
    store(paths.o, i, broadcast(camera.position));
    store(paths.d, i, fma(broadcast(camera.dx), px, fma(broadcast(camera.dy), py, broadcast(camera.corner))));
    store(paths.throughput, i, Vec{Float(1.f), Float(1.f), Float(1.f)});
    store(paths.arrival + i, Float(counts_all));
    store(paths.eta2 + i, Float(1.f));
    store(paths.names.light_u + i, n.u[2]);
    store(paths.names.light_v + i, n.u[3]);
    store(paths.names.slot + i, entry);
    store(paths.names.key + i, key);
    store(paths.names.index + i, Uint(index));
  }
}

/// Whether the material at offset `record` has all of the given traits.
CASTRAY_INLINE Mask has_traits(const KernelScene& scene, Uint record, uint32_t traits) {
  return (gather(&scene.materials->traits, record) & traits) == Uint(traits);
}

/// The part of a surface's own light that a ray counts (balance heuristic with light sampling).
CASTRAY_INLINE Vec found_emission(const KernelScene& scene, Uint material, Mask front, Float arrival,
                                  Float distance, Float cosine) {
  const KernelMaterial& first = *scene.materials;
  const Mask shines = front | has_traits(scene, material, trait_emits_behind);
  const Float light_pdf = gather(&first.light_density, material) * distance * distance / abs(cosine);
  const Float share =
      select(arrival >= Float(counts_all), Float(1.f), arrival / max(arrival + light_pdf, Float(0x1p-100f)));
  return select(shines, gather_vec(first.emission, material) * share, black());
}

/// The surface at each hit. Paths that miss collect the environment and end. `see_emission`: some rays count
/// it. With `keep_misses` every path keeps its place, and a miss is a black vertex without a normal.
template <uint32_t features, bool keep_misses>
CASTRAY_INLINE void surfaces(const Context& c, const Paths& paths, const Hits& hits, bool see_emission,
                             Vertices& out, Radiance& radiance) {
  const KernelScene& scene = c.scene;
  out.count = 0;
  for (int i = 0; i < paths.count; i += width) {
    const Mask active = first_lanes(paths.count - i);
    const Uint found = load(hits.primitive + i);
    const Mask hit = active & ~(found == Uint(no_hit));
    const Uint primitive = select(hit, found, Uint(0u));
    const Vec o = load(paths.o, i), d = load(paths.d, i), throughput = load(paths.throughput, i);
    const HitPoint x = hit_point<features>(scene, o, d, hits, i, primitive);
    const Float towards = dot(x.normal, d);
    const Mask front = towards < Float(0.f);
    const Vec facing = select(front, x.normal, -x.normal);
    Vec albedo = gather_vec(scene.materials->kd, x.material);
    if (see_emission) {
      const Float arrival = load(paths.arrival + i);
      const Vec emission = found_emission(scene, x.material, front, arrival, load(hits.t + i), towards);
      radiance.add(paths.names.slot + i, hit & (arrival > Float(0.f)), throughput * emission);
    }
    radiance.add(paths.names.slot + i, active & ~hit, throughput * broadcast(scene.environment));
    const Mask kept = keep_misses ? active : hit;
    const int n = out.count;
    if constexpr (features & feature_materials) {
      const Vec to_viewer = -normalize(d);
      Vec shading_normal = facing;
      if constexpr (features & feature_detail) {
        const Float b1 = load(hits.b1 + i), b2 = load(hits.b2 + i);
        shading_normal = smooth_normal(scene.triangles, primitive, b1, b2, facing, to_viewer);
        albedo = albedo * texture_tint(scene, x.material, primitive, b1, b2);
      }
      compress_store(out.wo, n, kept, to_viewer);
      compress_store(out.shading_normal, n, kept, shading_normal);
      compress_store(out.error + n, kept, x.error);
      compress_store(out.eta2 + n, kept, load(paths.eta2 + i));
    }
    const auto or_black = [&](Vec v) { return keep_misses ? select(hit, v, black()) : v; };
    compress_store(out.p, n, kept, or_black(fma(facing, x.error, x.p)));
    compress_store(out.normal, n, kept, or_black(facing));
    compress_store(out.albedo, n, kept, or_black(albedo));
    compress_store(out.throughput, n, kept, or_black(throughput));
    compress_store(out.material + n, kept, x.material | select(front, Uint(0x80000000u), Uint(0u)));
    compress_names(out.names, n, kept, paths.names, i);
    out.count += count(kept);
  }
}

/// The BSDF at vertices, the frame it lives in, and the viewer's direction there.
struct Shading {
  Bsdf bsdf;
  Frame frame;
  Vec wo, normal;

  /// Whether a direction is on the same side of the real surface as of the shading normal's: smooth normals
  /// must not let light through an opaque surface.
  CASTRAY_INLINE Mask consistent(Vec wi, Vec local) const {
    const Mask above = dot(wi, normal) > Float(0.f), local_above = local.z > Float(0.f);
    return (above & local_above) | (~above & ~local_above);
  }
};

CASTRAY_INLINE Bsdf gather_bsdf(const KernelScene& scene, Uint material, Vec kd) {
  const KernelMaterial& first = *scene.materials;
  const Uint record = material & 0x7fffffffu;
  const Mask front = (material >> 31) == Uint(1u);
  const Float ior = gather(&first.ior, record);
  return {gather(&first.kind, record),
          kd,
          gather_vec(first.ks, record),
          gather(&first.alpha, record),
          select(front, ior, Float(1.f) / ior),
          gather(&first.albedo, record),
          scene.albedos};
}

CASTRAY_INLINE Shading shading_of(const KernelScene& scene, const Vertices& v, int i) {
  const Frame frame = make_frame(load(v.shading_normal, i));
  return {gather_bsdf(scene, load(v.material + i), load(v.albedo, i)), frame, to_local(frame, load(v.wo, i)),
          load(v.normal, i)};
}

/// The normal on wi's side.
CASTRAY_INLINE Vec normal_towards(const Vertices& v, int i, Vec wi) {
  const Vec normal = load(v.normal, i);
  return select(dot(wi, normal) < Float(0.f), -normal, normal);
}

/// Where a ray in direction `wi` leaves a vertex: a point on wi's side.
CASTRAY_INLINE Vec leave(const Vertices& v, int i, Vec wi) {
  const Vec p = load(v.p, i), normal = load(v.normal, i);
  const Float across = select(dot(wi, normal) < Float(0.f), Float(-2.f) * load(v.error + i), Float(0.f));
  return fma(normal, across, p);
}

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
      const Shading shading = shading_of(c.scene, vertices, i);
      const Vec local = to_local(shading.frame, wi);
      const BsdfValue value = evaluate(shading.bsdf, shading.wo, local);
      f_cos = select(shading.consistent(wi, local), value.f_cos, black());
      pdf = value.pdf;
      p = leave(vertices, i, wi);
      normal = normal_towards(vertices, i, wi);
    } else {
      pdf = max(dot(normal, wi), Float(0.f)) * Float(1.f / pi);
      f_cos = load(vertices.albedo, i) * pdf;
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

/// Survival probability of a path about to leave `vertex`; capped, even where it is fixed, so that every path
/// ends.
CASTRAY_INLINE Float survival(const KernelOptions& options, uint32_t vertex, uint32_t first_roulette,
                              Float brightest) {
  constexpr float highest = 0.95f;
  if (options.fixed_roulette)
    return Float(vertex < 1000 || options.survival < highest ? options.survival : highest);
  return vertex < first_roulette ? Float(1.f) : min(brightest, Float(highest));
}

/// The next ray of each path that survives the roulette.
template <uint32_t features>
CASTRAY_INLINE void scatter(const Context& c, const Vertices& vertices, uint32_t vertex,
                            uint32_t first_roulette, Paths& out) {
  out.count = 0;
  const bool roulette = c.options.fixed_roulette || vertex >= first_roulette;
  for (int i = 0; i < vertices.count; i += width) {
    const Sequence sequence = sequence_of(vertices.names, i);
    const Numbers<4> n = draw<4>(c.options.sobol, sequence, direction_block(vertex));
    Vec throughput = load(vertices.throughput, i), o = load(vertices.p, i), wi;
    Float arrival(0.f), eta2(1.f), brightest;
    Numbers<2> choice{{Float(0.f), Float(0.f)}};
    if (roulette || (features & feature_materials))
      choice = draw<2>(c.options.sobol, sequence, choice_block(vertex));
    if constexpr (features & feature_materials) {
      const Shading shading = shading_of(c.scene, vertices, i);
      const BsdfSample s = sample(shading.bsdf, shading.wo, choice.u[1], n.u[0], n.u[1]);
      wi = to_world(shading.frame, s.wi);
      throughput = throughput * select(shading.consistent(wi, s.wi), s.weight, black());
      arrival = select(s.specular, Float(counts_all), c.options.mis ? s.pdf : Float(0.f));
      eta2 = load(vertices.eta2 + i) * s.eta2;
      brightest = max_component(throughput) * eta2;
      o = leave(vertices, i, wi);
    } else {
      const Vec local = cosine_hemisphere(n.u[0], n.u[1]);
      wi = to_world(make_frame(load(vertices.normal, i)), local);
      throughput = throughput * load(vertices.albedo, i);
      if (c.options.mis) arrival = local.z * Float(1.f / pi);
      brightest = max_component(throughput);
    }
    Mask alive = first_lanes(vertices.count - i) & ~(brightest <= Float(0.f));
    if (roulette) {
      const Float p = survival(c.options, vertex, first_roulette, brightest);
      alive = alive & (choice.u[0] < p);
      throughput = throughput * (Float(1.f) / p);
    }
    const int k = out.count;
    compress_store(out.o, k, alive, o);
    compress_store(out.d, k, alive, wi);
    compress_store(out.throughput, k, alive, throughput);
    compress_store(out.arrival + k, alive, arrival);
    compress_store(out.eta2 + k, alive, eta2);
    compress_names(out.names, k, alive, vertices.names, i);
    compress_store(out.names.light_u + k, alive, n.u[2]);
    compress_store(out.names.light_v + k, alive, n.u[3]);
    out.count += count(alive);
  }
}

}  // namespace castray::CASTRAY_ISA
