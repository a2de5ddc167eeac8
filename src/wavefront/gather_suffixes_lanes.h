#pragma once

#include "lights/light_share_lanes.h"
#include "wavefront/gather_light_lanes.h"
#include "wavefront/radiance_lanes.h"
#include "wavefront/suffixes_lanes.h"

namespace castray::CASTRAY_ISA {

/// The BSDF of a glossy suffix, the same in all lanes, and its shading frame.
struct GlossySuffix {
  Bsdf bsdf;
  Frame frame;
};

template <uint32_t features>
CASTRAY_INLINE GlossySuffix glossy_suffix(const KernelScene& scene, const Vertices& y, int k) {
  return {gather_bsdf(scene, Uint(y.material[k]), broadcast_entry<features>(y.parameters, k)),
          make_frame(broadcast_entry(y.shading_normal, k))};
}

/// Adds the radiance that the glossy end y_j of a suffix sends to each pixel of the tile. `lit`: from its
/// light point, over the sum of pdfs. `arriving`: along the next segment, times the stratum; its weight
/// is the balance heuristic over all x_k, as each could have made y_j choose this direction. `emission`:
/// its own.
template <uint32_t features>
CASTRAY_INLINE void add_glossy(const KernelScene& scene, const Suffixes& suffixes, int suffix,
                               const Gatherers& tile, const Transfer& t, const Vec& lit, const Vec& arriving,
                               const Vec& emission, Gathered& gathered) {
  const int entry = (int)suffixes.landed[suffix] - 1;
  const GlossySuffix y = glossy_suffix<features>(scene, suffixes.y, entry);
  const Vec p = broadcast_entry(suffixes.y.p, entry);
  const Vec to_light = to_local(y.frame, broadcast_entry(suffixes.to_light, suffix));
  const Vec onward = to_local(y.frame, broadcast_entry(suffixes.onward, suffix));
  Float density[tile_vectors];
  Vec reflected[tile_vectors], direct[tile_vectors];
  for (int i = 0; i < tile_vectors; ++i) {
    const Vec wo = to_local(y.frame, normalize(load(tile.x.p, tile.first + i * width) - p));
    const BsdfValue next = evaluate(y.bsdf, wo, onward);
    direct[i] = evaluate(y.bsdf, wo, to_light).f_cos * lit;
    reflected[i] = next.f_cos * arriving;
    density[i] = select(t.density[i] > Float(0.f), t.density[i] * next.pdf, Float(0.f));
  }
  const float sum = ordered_sum(density);
  const Float inverse(sum > 0 ? 1.f / sum : 0.f);
  for (int i = 0; i < tile_vectors; ++i) {
    const Vec radiance = fma(reflected[i], inverse, direct[i]) + emission;
    const Vec more = select(t.density[i] > Float(0.f), t.weight[i] * radiance, black());
    store(gathered.sum, tile.first + i * width, load(gathered.sum, tile.first + i * width) + more);
  }
}

/// Every pixel of a tile gathers from every suffix of the tile that landed.
template <class Geometry, uint32_t features>
CASTRAY_STAGE void gather_suffixes(Context& c, const Vertices& x, const TileBoxes* boxes,
                                   const Suffixes& suffixes, const Radiance& radiance, VisibilityScratch& s,
                                   Gathered& gathered) {
  for (int tile = 0; tile < c.job.tiles; ++tile) {
    const float stratum = stratum_of(c, suffixes.origins[tile]);
    Gatherers gatherers{x, tile * tile_pixels, boxes[tile]};
    for (int j = 0; j < c.options.suffixes; ++j) {
      const int suffix = tile * tile_pixels + j, slot = batch_size + suffix,
                origin = (int)suffixes.origin[suffix];
      if (!suffixes.landed[suffix]) continue;
      const Vec reflected = radiance.at(slot);
      const int entry = (int)suffixes.landed[suffix] - 1;
      const bool glossy = (features & feature_materials) && suffixes.glossy[entry];
      const Vec emitted = broadcast_entry(suffixes.emission, entry);
      const Vec lit = glossy ? radiance.at(slot + batch_size) : black();
      if (all(max_component(reflected + emitted + lit) <= Float(0.f))) continue;
      Transfer t;
      transfer<Geometry, features>(
          c,
          Sender{broadcast_entry(suffixes.y.p, entry), broadcast_entry(suffixes.y.normal, entry),
                 origin - gatherers.first},
          gatherers, s, t);
      const float density = ordered_sum(t.density) / stratum;
      if (!(density > 0)) continue;
      const Vec emission =
          emitted * (bsdf_share(Float(suffixes.light_density[entry]), Float(density)) * Float(1.f / density));
      if constexpr (features & feature_materials) {
        if (glossy) {
          c.evaluated += 2 * tile_pixels;
          add_glossy<features>(c.scene, suffixes, suffix, gatherers, t, lit * Float(1.f / density),
                               reflected * Float(stratum), emission, gathered);
          continue;
        }
      }
      add_scaled<features>(gathered, gatherers.first, t, fma(reflected, Float(1.f / density), emission));
    }
  }
}

}  // namespace castray::CASTRAY_ISA
