#pragma once

#include "lights/light_share_lanes.h"
#include "wavefront/gather_light_lanes.h"
#include "wavefront/radiance_lanes.h"
#include "wavefront/suffixes_lanes.h"

namespace castray::CASTRAY_ISA {

/// The glossy end y_j of a suffix as a tile's points see it: its BSDF, the same in all lanes, its shading
/// frame, and wo to each point; and the transfer p_kj to these.
struct GlossyEnd {
  Bsdf bsdf;
  Frame frame;
  Vec wo[tile_vectors];
  const Transfer& t;
};

template <uint32_t features>
CASTRAY_INLINE GlossyEnd glossy_end(const KernelScene& scene, const Vertices& y, int k, const Gatherers& tile,
                                    const Transfer& t) {
  GlossyEnd end{gather_bsdf(scene, Uint(y.material[k]), broadcast_entry<features>(y.parameters, k)),
                make_frame(broadcast_entry(y.shading_normal, k)),
                {},
                t};
  const Vec p = broadcast_entry(y.p, k);
  for (int i = 0; i < tile_vectors; ++i)
    end.wo[i] = to_local(end.frame, normalize(load(tile.x.p, tile.first + i * width) - p));
  return end;
}

/// Adds to `sent` what y reflects to each point of light from direction w. `radiance_of(q)`: of that light,
/// by the sum q over k of p_kj q_k, where q_k is the pdf with which y_j would have chosen w if x_k had found
/// it.
template <class RadianceOf>
CASTRAY_INLINE void add_reflected(const GlossyEnd& y, const Vec& w, RadianceOf radiance_of,
                                  Vec (&sent)[tile_vectors]) {
  const Vec wi = to_local(y.frame, w);
  Vec f_cos[tile_vectors];
  Float density[tile_vectors];
  for (int i = 0; i < tile_vectors; ++i) {
    const BsdfValue value = evaluate(y.bsdf, y.wo[i], wi);
    f_cos[i] = value.f_cos;
    density[i] = select(y.t.density[i] > Float(0.f), y.t.density[i] * value.pdf, Float(0.f));
  }
  const Vec radiance = radiance_of(Float(ordered_sum(density)));
  for (int i = 0; i < tile_vectors; ++i) sent[i] = fma_vec(f_cos[i], radiance, sent[i]);
}

/// Adds the radiance that the glossy end of a suffix sends to each pixel of the tile; `emission`: its own.
/// What y reflects has the weight of the balance heuristic over all x_k that could have made it choose a
/// direction, and its MIS weight where light sampling could have.
template <uint32_t features>
CASTRAY_INLINE void add_glossy(Context& c, const Suffixes& suffixes, int suffix, const Radiance& radiance,
                               const Gatherers& tile, const Transfer& t, float stratum, const Vec& emission,
                               Gathered& gathered) {
  const GlossyEnd y = glossy_end<features>(c.scene, suffixes.y, (int)suffixes.landed[suffix] - 1, tile, t);
  const Float found(ordered_sum(t.density)), m(stratum);
  const auto direction = [&](const LightDirections& to) { return broadcast_entry(to.w, suffix); };
  const auto pdf = [&](const LightDirections& to) { return found * Float(to.pdf[suffix]); };
  Vec sent[tile_vectors];
  for (Vec& v : sent) v = emission;
  const auto add_sampled = [&](const LightDirections& to, const Vec& arriving) {
    if (all(max_component(arriving) <= Float(0.f))) return;
    c.evaluated += tile_pixels;
    add_reflected(
        y, direction(to),
        [&](Float q) {
          const Float share = c.options.mis ? light_share(pdf(to), q) : Float(1.f);
          return arriving * (share * m / found);
        },
        sent);
  };
  const int slot = batch_size + suffix;
  add_sampled(suffixes.to_light, radiance.at(slot + batch_size));
  add_sampled(suffixes.to_sky, radiance.at(slot + 2 * batch_size));
  const Vec onward = radiance.at(slot), lights = broadcast_entry(suffixes.found, suffix);
  if (any(max_component(onward + lights) > Float(0.f))) {
    c.evaluated += tile_pixels;
    add_reflected(
        y, direction(suffixes.onward),
        [&](Float q) {
          const Vec arriving = fma(lights, bsdf_share(pdf(suffixes.onward), q), onward);
          return select(q > Float(0.f), arriving * (m / q), black());
        },
        sent);
  }
  for (int i = 0; i < tile_vectors; ++i) {
    const Vec more = select(t.density[i] > Float(0.f), t.weight[i] * sent[i], black());
    store(gathered.sum, tile.first + i * width, load(gathered.sum, tile.first + i * width) + more);
  }
}

/// Every pixel of a tile gathers from every suffix of the tile that landed.
template <class Geometry, uint32_t features>
CASTRAY_STAGE void gather_suffixes(Context& c, const Vertices& x, const TileBoxes* boxes,
                                   const Suffixes& suffixes, const Radiance& radiance, VisibilityScratch& s,
                                   Gathered& gathered) {
  for (int tile = 0; tile < c.job.tiles; ++tile) {
    const Origins& origins = suffixes.origins[tile];
    const float stratum = stratum_of(c, origins);
    Gatherers gatherers{x, tile * tile_pixels, boxes[tile]};
    for (int j = 0; j < c.options.suffixes; ++j) {
      const int suffix = tile * tile_pixels + j, slot = batch_size + suffix,
                origin = (int)suffixes.origin[suffix];
      if (!suffixes.landed[suffix]) continue;
      const Vec reflected = radiance.at(slot);
      const int entry = (int)suffixes.landed[suffix] - 1;
      const bool glossy = (features & feature_materials) && suffixes.glossy[entry];
      const Vec emitted = broadcast_entry(suffixes.emission, entry);
      Vec sent = reflected + emitted;
      if (glossy)
        sent = sent + radiance.at(slot + batch_size) + radiance.at(slot + 2 * batch_size) +
               broadcast_entry(suffixes.found, suffix);
      if (all(max_component(sent) <= Float(0.f))) continue;
      Transfer t;
      transfer<Geometry, features>(
          c,
          Sender{broadcast_entry(suffixes.y.p, entry), broadcast_entry(suffixes.y.normal, entry),
                 origin - gatherers.first, true},
          gatherers, s, t);
      const float density = found_from(origins, t.density) / stratum;
      if (!(density > 0)) continue;
      const Vec emission =
          emitted * (bsdf_share(Float(suffixes.light_density[entry]), Float(density)) * Float(1.f / density));
      if constexpr (features & feature_materials) {
        if (glossy) {
          if (!origins.even)
            for (int i = 0; i < tile_vectors; ++i) t.density[i] *= load(origins.share + i * width);
          add_glossy<features>(c, suffixes, suffix, radiance, gatherers, t, stratum, emission, gathered);
          continue;
        }
      }
      add_scaled<features>(gathered, gatherers.first, t, fma(reflected, Float(1.f / density), emission));
    }
  }
}

}  // namespace castray::CASTRAY_ISA
