#pragma once

#include "wavefront/caustic_rays_lanes.h"
#include "wavefront/sequence_keys_lanes.h"
#include "wavefront/shading_lanes.h"
#include "wavefront/suffixes_lanes.h"

namespace castray::CASTRAY_ISA {

/// Sequence indices of the suffixes of a tile. Under an environment runs of 2^k suffixes have runs of
/// indices, so that what points of one orientation send out is stratified.
CASTRAY_INLINE Uint suffix_index(const Context& c, const TileSequence& tile, Uint item, uint32_t per_tile) {
  if (!c.scene.lights.environment.shines) return tile_index(tile, item, per_tile);
  const uint32_t order = hash_once(tile.key, (uint32_t)tile.sample) & (per_tile - 1);
  return (item ^ Uint(order)) + Uint(((uint32_t)tile.sample * per_tile) & ((1u << index_bits) - 1));
}

/// 1 over the expected number of suffixes that start at these pixels of a tile.
CASTRAY_INLINE Float points_of_suffixes(const Context& c, const Origins& origins, Uint pixel) {
  const Float mean(stratum_of(c, origins));
  return origins.even ? mean : mean / gather(origins.share, pixel);
}

/// Starts the suffixes: one BSDF sample at a random point of each stratum of a tile's origins. `guided`:
/// their points send rays to caustics, too.
template <uint32_t features>
CASTRAY_STAGE void start_suffixes(const Context& c, const Vertices& x, bool guided, Suffixes& suffixes,
                                  Paths& out) {
  const auto per_tile = (uint32_t)c.options.suffixes;
  const Vec one{Float(1.f), Float(1.f), Float(1.f)};
  out.count = 0;
  for (int tile = 0; tile < c.job.tiles; ++tile) {
    const TileSequence sequence = tile_sequence(c, tile);
    const uint32_t key = sequence.key, choice_key = hash_once(key, (uint32_t)sequence.sample);
    const Origins& origins = suffixes.origins[tile];
    for (uint32_t j = 0; j < per_tile; j += width) {
      const Uint item = Uint(j) + lane_index(), suffix = Uint((uint32_t)(tile * tile_pixels)) + item;
      const Uint u = hash_combine(Uint(choice_key), item + 0x51u) >> 16;
      const Uint rank = origins.even
                            ? (item * origins.count + (u * origins.count >> 16)) >> __builtin_ctz(per_tile)
                            : point_at(origins, (item << 16) + u);
      const Mask there = item < Uint(per_tile);
      const Uint entry = gather(origins.entry, select(there, rank, Uint(0u)));
      const Uint pixel = entry - Uint((uint32_t)(tile * tile_pixels));
      const Uint index = suffix_index(c, sequence, item, per_tile);
      const Numbers<4> n = draw<4>(c.options.sobol, {Uint(key), index}, PathBlocks::direction(0));
      const Vec normal = gather_entries(x.normal, entry);
      const Parameters<features> parameters = gather_entries<features>(x.parameters, entry);
      Vec wi, weight = parameters.kd();
      Mask going = there & (length_squared(normal) > Float(0.f));
      if constexpr (features & feature_materials) {
        const Frame frame = make_frame(gather_entries(x.shading_normal, entry));
        const Shading shading{gather_bsdf(c.scene, gather(x.material, entry), parameters), frame,
                              to_local(frame, gather_entries(x.wo, entry)), normal};
        const Numbers<2> choice = draw<2>(c.options.sobol, {Uint(key), index}, PathBlocks::choice(0));
        const BsdfSample s = sample(shading.bsdf, shading.wo, choice.u[1], n.u[0], n.u[1]);
        wi = to_world(frame, s.wi);
        weight = select(shading.consistent(wi, s.wi), s.weight, black());
        going = going & shading.consistent(wi, s.wi) & ~(s.pdf <= Float(0.f));
        if (guided)
          weight = weight * share_of_suffix(c, origins, pixel, gather_entries(x.p, entry), wi, s.pdf);
      } else {
        wi = to_world(make_frame(normal), cosine_hemisphere(n.u[0], n.u[1]));
      }
      const int first = tile * tile_pixels + (int)j, k = out.count;
      store(suffixes.origin + first, entry);
      store(suffixes.landed + first, Uint(0u));
      if constexpr (features & feature_materials) store(suffixes.found, first, black());
      store(suffixes.weight, first, weight * points_of_suffixes(c, origins, pixel));
      compress_store(out.o, k, going, gather_entries(x.p, entry));
      compress_store(out.d, k, going, wi);
      compress_store(out.throughput, k, going, one);
      compress_store(out.arrival + k, going, Float(0.f));
      compress_store(out.eta2 + k, going, Float(1.f));
      if (c.scene.absorbing) compress_store(out.media + k, going, gather(x.media, entry));
      compress_store(out.names.slot + k, going, suffix + Uint((uint32_t)batch_size));
      compress_store(out.names.key + k, going, Uint(key));
      compress_store(out.names.index + k, going, index);
      compress_store(out.names.light_u + k, going, n.u[2]);
      compress_store(out.names.light_v + k, going, n.u[3]);
      out.count += count(going);
    }
  }
}

}  // namespace castray::CASTRAY_ISA
