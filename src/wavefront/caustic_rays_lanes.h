#pragma once

#include "lights/arrival_guide_lanes.h"
#include "wavefront/follow_lanes.h"
#include "wavefront/scratch_lanes.h"

// Where the camera sees a surface by way of mirrors and glass, suffixes find caustics there by chance: each
// serves its own pixel if it meets mirrors or glass again. So each of these points sends a ray more, in a
// direction from which caustics arrive (see ArrivalGuide). Of what it meets mirrors and glass count alone,
// and the balance heuristic weighs it and suffixes.

namespace castray::CASTRAY_ISA {

/// How many suffixes are expected to start at these pixels of a tile.
CASTRAY_INLINE Float suffixes_of_pixel(const Context& c, const Origins& origins, Uint pixel) {
  const Float mean((float)c.options.suffixes / (float)origins.count);
  return origins.even ? mean : mean * gather(origins.share, pixel);
}

/// Of what a suffix from p, which a pixel sees, with this pdf brings where it meets mirrors or glass, the
/// balance heuristic's share.
CASTRAY_INLINE Float share_of_suffix(const Context& c, const Origins& origins, Uint pixel, const Vec& p,
                                     const Vec& wi, Float pdf) {
  const ArrivalGuideTable& arrivals = c.scene.lights.arrivals;
  const Float by_suffixes = pdf * suffixes_of_pixel(c, origins, pixel);
  return by_suffixes / (by_suffixes + arrival_pdf(arrivals, arrivals_at(arrivals, p), wi));
}

/// A ray from each of the points x, with its part of the pixel's radiance.
template <uint32_t features>
CASTRAY_STAGE void aim_at_caustics(const Context& c, const Vertices& x, const Suffixes& suffixes,
                                   Paths& out) {
  const ArrivalGuideTable& arrivals = c.scene.lights.arrivals;
  out.count = 0;
  for (int i = 0; i < x.count; i += width) {
    const Mask there = first_lanes(x.count - i) & (length_squared(load(x.normal, i)) > Float(0.f));
    if (none(there)) continue;
    const Uint key = hash_combine(load(x.names.key + i), Uint(0xca057u)), index = load(x.names.index + i);
    const Numbers<4> n = draw<4>(c.options.sobol, {key, index}, PathBlocks::direction(0));
    const Numbers<2> choice = draw<2>(c.options.sobol, {key, index}, PathBlocks::choice(0));
    const Uint row = arrivals_at(arrivals, load(x.p, i));
    const Vec wi = direction_in(arrivals.cumulative, row, choice.u[1], n.u[0], n.u[1]);
    const Shading shading = shading_of<features>(c.scene, x, i);
    const Vec local = to_local(shading.frame, wi);
    const BsdfValue value = evaluate(shading.bsdf, shading.wo, local);
    const Uint pixel = Uint((uint32_t)(i % tile_pixels)) + lane_index();
    const Float by_suffixes = value.pdf * suffixes_of_pixel(c, suffixes.origins[i / tile_pixels], pixel);
    const Float weight = Float(1.f) / (arrival_pdf(arrivals, row, wi) + by_suffixes);
    const Vec throughput = load(x.throughput, i) * value.f_cos * weight;
    const Mask going = there & shading.consistent(wi, local) & (max_component(throughput) > Float(0.f));
    const int k = out.count;
    compress_store(out.o, k, going, leave(x, i, wi));
    compress_store(out.d, k, going, wi);
    compress_store(out.throughput, k, going, throughput);
    compress_store(out.arrival + k, going, Float(0.f));
    compress_store(out.eta2 + k, going, load(x.eta2 + i));
    if (c.scene.absorbing) compress_store(out.media + k, going, media_towards(c.scene, x, i, wi));
    compress_entries(out.names, k, going, x.names, i);
    compress_store(out.names.key + k, going, key);
    compress_store(out.names.light_u + k, going, n.u[2]);
    compress_store(out.names.light_v + k, going, n.u[3]);
    out.count += count(going);
  }
}

/// Leaves out what suffixes alone find: light from outside the scene, and all that a tile shares.
CASTRAY_STAGE inline void keep_unshared(const KernelScene& scene, Vertices& vertices) {
  const int found = vertices.count;
  vertices.count = 0;
  for (int i = 0; i < found; i += width) {
    const Mask active = first_lanes(found - i);
    const Uint record = select(active, record_of(load(vertices.material + i)), Uint(0u));
    const Mask kept = active & ~has_traits(scene, record, trait_shareable);
    compress_entries<VertexArrays>(vertices, vertices.count, kept, vertices, i);
    vertices.count += count(kept);
  }
}

/// Traces these rays to the ends of their paths, and adds what they bring to the pixels' radiance.
template <class Geometry, uint32_t features>
CASTRAY_STAGE void trace_caustic_rays(Context& c, Scratch& s, const Vertices& x) {
  aim_at_caustics<features>(c, x, s.suffixes, s.paths);
  closest<Geometry>(c, s.paths, false, s.hits);
  for (int i = 0; i < s.paths.count; i += width) {
    const Mask escaped = load(s.hits.primitive + i) == Uint(no_hit);
    store(s.paths.throughput, i, select(escaped, black(), load(s.paths.throughput, i)));
  }
  absorb<Geometry>(c, s.hits, false, s.paths);
  surfaces<Geometry, features, false>(c, s.paths, s.hits, false, s.vertices, s.radiance);
  keep_unshared(c.scene, s.vertices);
  if (s.vertices.count > 0) follow<Geometry, features>(c, s, s.vertices, 1, first_roulette_of_suffixes);
}

}  // namespace castray::CASTRAY_ISA
