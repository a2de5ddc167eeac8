#pragma once

#include "wavefront/gather_lanes.h"

// Paths shared by the pixels of a tile (after Bekaert, Sbert and Halton 2002).
//
// From some of a tile's camera hits x_k one bounce is traced to a point y_j, where the light that leaves is
// estimated once; every x_i of the tile then gathers from every y_j. With w_ij = f cos cos' V / |x_i - y_j|^2
// and p_kj the density per area with which x_k finds y_j (visibility included: it depends on k), the balance
// heuristic over all x_k that could have been the origin gives pixel i
//
//     L_j w_ij m / sum_k p_kj,
//
// m the number of pixels among which each origin was chosen uniformly. Light points are shared the same way;
// where a suffix ends on a light, both ways of finding that point share its emission.

namespace castray::CASTRAY_ISA {

CASTRAY_INLINE uint32_t hash_once(uint32_t a, uint32_t b) { return lane(hash_combine(Uint(a), Uint(b)), 0); }

CASTRAY_INLINE uint32_t tile_key(const Context& c, int tile) {
  const uint32_t key = hash_once(
      hash_once(hash_once(c.options.seed, 0x7411u), (uint32_t)(c.job.grid_x + tile)), (uint32_t)c.job.grid_y);
  return lane(with_epoch(Uint(key), c.job.sample), 0);
}

/// Places of items of `count` (a power of two) in the sequence of a tile: each pass uses the next `count`
/// indices, in an order of its own.
CASTRAY_INLINE Uint tile_index(uint32_t key, uint64_t sample, Uint item, uint32_t count) {
  const uint32_t order = hash_once(key, (uint32_t)sample);
  const Uint low(count - 1);
  Uint v = (item ^ Uint(order)) * ((order >> 8) | 1u);
  v = (v ^ ((v & low) >> 2)) * ((order >> 16) | 1u);
  return (((v + (order >> 24)) & low) + Uint((uint32_t)sample * count)) & ((1u << index_bits) - 1);
}

CASTRAY_INLINE Vec broadcast_lane(const Vec& v, int l) {
  return {Float(lane(v.x, l)), Float(lane(v.y, l)), Float(lane(v.z, l))};
}
template <int N>
CASTRAY_INLINE Vec broadcast_entry(const VecArray<N>& a, int i) {
  return {Float(a.x[i]), Float(a.y[i]), Float(a.z[i])};
}

/// The pixels of a tile that one suffix stands for.
CASTRAY_INLINE float stratum_of(const KernelOptions& options) {
  return (float)(tile_pixels / options.suffixes);
}

/// The points of a tile, none of which lets light through, as one receiver.
CASTRAY_INLINE Receiver receiver_of(const Gatherers& tile) {
  Float x[tile_vectors], y[tile_vectors], z[tile_vectors];
  for (int i = 0; i < tile_vectors; ++i) {
    const Vec normal = load(tile.x.normal, tile.first + i * width);
    x[i] = normal.x;
    y[i] = normal.y;
    z[i] = normal.z;
  }
  const Float one(1.f);
  const Vec sum{Float(ordered_sum(x)), Float(ordered_sum(y)), Float(ordered_sum(z))}, mean = normalize(sum);
  Float least = one;
  for (int i = 0; i < tile_vectors; ++i) {
    const Vec normal = load(tile.x.normal, tile.first + i * width);
    least = min(least, select(length_squared(normal) > Float(0.f), dot(mean, normal), one));
  }
  float cosine = 1;
  for (int l = 0; l < width; ++l) cosine = lane(least, l) < cosine ? lane(least, l) : cosine;
  cosine -= 0x1p-12f;
  const float* half = tile.boxes.all.half;
  return {broadcast(tile.boxes.all.center),
          mean,
          Float(__builtin_sqrtf(half[0] * half[0] + half[1] * half[1] + half[2] * half[2])),
          Float(cosine),
          Float(__builtin_sqrtf(1 - cosine * cosine)),
          (Float(0.5f) < Float(cosine)) & (length_squared(sum) > Float(0.f))};
}

/// The light points of one tile, `count` <= width of them at once.
CASTRAY_INLINE LightPoint tile_light_points(const Context& c, const Receiver& tile, uint32_t key, int first) {
  const auto points = (uint32_t)c.options.light_points;
  const Uint index = tile_index(key, c.job.sample, Uint((uint32_t)first) + lane_index(), points);
  const Numbers<4> n = draw<4>(c.options.sobol, {Uint(key), index}, 0);
  const Mask second_half = Float(0.5f) <= n.u[3];
  const Float deep = fma(n.u[3], Float(2.f), select(second_half, Float(-1.f), Float(0.f)));
  LightPoint point = sample_light(c.scene.lights, tile, n.u[0], deep, n.u[1], n.u[2]);
  const Mask back = point.two_sided & ~second_half;
  const Float sides = select(point.two_sided, Float(2.f), Float(1.f));
  point.normal = select(back, -point.normal, point.normal);
  point.weight = point.weight * (sides * Float(1.f / (float)points));
  point.density = point.density * Float((float)points) / sides;
  point.p = fma(point.normal, point.error, point.p);
  return point;
}

/// Light points shared by each tile.
template <uint32_t features>
CASTRAY_INLINE void gather_light(Context& c, const Vertices& x, const TileBoxes* boxes, const FarEnds& ends,
                                 VisibilityScratch& s, Gathered& gathered) {
  if (c.scene.lights.count == 0) return;
  const int points = c.options.light_points;
  for (int tile = 0; tile < c.job.tiles; ++tile) {
    Gatherers gatherers{x, tile * tile_pixels, boxes[tile]};
    const uint32_t key = tile_key(c, tile);
    const Receiver receiver = receiver_of(gatherers);
    for (int first = 0; first < points; first += width) {
      const LightPoint point = tile_light_points(c, receiver, key, first);
      for (int l = 0; l < width && first + l < points; ++l) {
        Transfer t;
        transfer<features>(c, {broadcast_lane(point.p, l), broadcast_lane(point.normal, l), -1}, gatherers,
                           ends, s, t);
        const float density = lane(point.density, l);
        const float share =
            c.options.mis ? density / (density + ordered_sum(t.density) / stratum_of(c.options)) : 1.f;
        add_scaled<features>(gathered, gatherers.first, t, broadcast_lane(point.weight, l) * Float(share));
      }
    }
  }
}

/// The suffixes of a job: suffix j of tile t has slot batch_size + 64 t + j.
struct Suffixes {
  VecArray<batch_size> p, normal, emission;
  alignas(64) float light_density[batch_size];  ///< of light points at y
  alignas(64) uint32_t landed[batch_size];      ///< 0: there is no y
  alignas(64) uint32_t origin[batch_size];      ///< entry of the camera vertex it started from
  VecArray<batch_size> weight;                  ///< f cos / pdf there, times the stratum
  // Of glossy y, which reflect to each pixel what it gets by itself:
  alignas(64) uint32_t glossy[batch_size];
  VecArray<batch_size> shading_normal, albedo;
  alignas(64) uint32_t material[batch_size];
  VecArray<batch_size> to_light, onward;  ///< directions: to the light point, and of the next segment
};

template <int N>
CASTRAY_INLINE Vec gather_entries(const VecArray<N>& a, Uint i) {
  return {gather(a.x, i), gather(a.y, i), gather(a.z, i)};
}

/// One bounce from one pixel of each stratum.
template <uint32_t features>
CASTRAY_INLINE void start_suffixes(const Context& c, const Vertices& x, Suffixes& suffixes, Paths& out) {
  const auto per_tile = (uint32_t)c.options.suffixes;
  const uint32_t stratum = tile_pixels / per_tile;
  const int shift = __builtin_ctz(stratum);
  const Vec one{Float(1.f), Float(1.f), Float(1.f)};
  out.count = 0;
  for (int tile = 0; tile < c.job.tiles; ++tile) {
    const uint32_t key = tile_key(c, tile), choice_key = hash_once(key, (uint32_t)c.job.sample);
    for (uint32_t j = 0; j < per_tile; j += width) {
      const Uint item = Uint(j) + lane_index(), suffix = Uint((uint32_t)(tile * tile_pixels)) + item;
      const Uint in_stratum = hash_combine(Uint(choice_key), item + 0x51u) & (stratum - 1);
      const Mask there = item < Uint(per_tile);
      const Uint entry =
          Uint((uint32_t)(tile * tile_pixels)) + select(there, (item << shift) + in_stratum, Uint(0u));
      const Uint index = tile_index(key, c.job.sample, item, per_tile);
      const Numbers<4> n = draw<4>(c.options.sobol, {Uint(key), index}, direction_block(0));
      const Vec normal = gather_entries(x.normal, entry), albedo = gather_entries(x.albedo, entry);
      Vec wi, weight = albedo;
      if constexpr (features & feature_materials) {
        const Frame frame = make_frame(gather_entries(x.shading_normal, entry));
        const Shading shading{gather_bsdf(c.scene, gather(x.material, entry), albedo), frame,
                              to_local(frame, gather_entries(x.wo, entry)), normal};
        const Numbers<2> choice = draw<2>(c.options.sobol, {Uint(key), index}, choice_block(0));
        const BsdfSample s = sample(shading.bsdf, shading.wo, choice.u[1], n.u[0], n.u[1]);
        wi = to_world(frame, s.wi);
        weight = select(shading.consistent(wi, s.wi), s.weight, black());
      } else {
        wi = to_world(make_frame(normal), cosine_hemisphere(n.u[0], n.u[1]));
      }
      const Mask going =
          there & (length_squared(normal) > Float(0.f)) & ~(max_component(weight) <= Float(0.f));
      const int first = tile * tile_pixels + (int)j, k = out.count;
      store(suffixes.origin + first, entry);
      store(suffixes.landed + first, Uint(0u));
      store(suffixes.weight, first, weight * Float((float)stratum));
      compress_store(out.o, k, going, gather_entries(x.p, entry));
      compress_store(out.d, k, going, wi);
      compress_store(out.throughput, k, going, one);
      compress_store(out.arrival + k, going, Float(0.f));
      compress_store(out.eta2 + k, going, Float(1.f));
      compress_store(out.names.slot + k, going, suffix + Uint((uint32_t)batch_size));
      compress_store(out.names.key + k, going, Uint(key));
      compress_store(out.names.index + k, going, index);
      compress_store(out.names.light_u + k, going, n.u[2]);
      compress_store(out.names.light_v + k, going, n.u[3]);
      out.count += count(going);
    }
  }
}

template <int N>
CASTRAY_INLINE void copy_entry(VecArray<N>& to, uint32_t i, const float* x, const float* y, const float* z,
                               int k) {
  to.x[i] = x[k];
  to.y[i] = y[k];
  to.z[i] = z[k];
}

CASTRAY_INLINE const KernelMaterial& material_of(const KernelScene& scene, uint32_t record) {
  return scene.materials[(record & 0x7fffffffu) / material_floats];
}

/// Keeps where the suffixes have landed and what is emitted there, where light sampling shares it.
/// Diffuse and rough points are shared: what mirrors and glass send on goes on as a plain path of the pixel
/// it came from.
template <uint32_t features>
CASTRAY_INLINE void keep_suffixes(const Context& c, Vertices& y, Suffixes& suffixes) {
  for (int k = 0; k < y.count; ++k) {
    const uint32_t suffix = y.names.slot[k] - batch_size;
    const KernelMaterial& material = material_of(c.scene, y.material[k]);
    const bool both_sides = material.traits & trait_emits_behind;
    const bool shines = c.options.mis && (both_sides || y.material[k] >> 31);
    const float* e = material.emission;
    suffixes.landed[suffix] = 1;
    copy_entry(suffixes.p, suffix, y.p.x, y.p.y, y.p.z, k);
    copy_entry(suffixes.normal, suffix, y.normal.x, y.normal.y, y.normal.z, k);
    suffixes.emission.x[suffix] = shines ? e[0] : 0.f;
    suffixes.emission.y[suffix] = shines ? e[1] : 0.f;
    suffixes.emission.z[suffix] = shines ? e[2] : 0.f;
    suffixes.light_density[suffix] =
        material.light_density * (float)c.options.light_points / (both_sides ? 2.f : 1.f);
    suffixes.glossy[suffix] = 0;
    if (!(features & feature_materials) || !(material.traits & trait_directional)) continue;
    if (material.traits & trait_shareable) {
      suffixes.glossy[suffix] = 1;
      suffixes.material[suffix] = y.material[k];
      copy_entry(suffixes.shading_normal, suffix, y.shading_normal.x, y.shading_normal.y, y.shading_normal.z,
                 k);
      copy_entry(suffixes.albedo, suffix, y.albedo.x, y.albedo.y, y.albedo.z, k);
    } else {
      y.names.slot[k] = suffixes.origin[suffix];
      copy_entry(y.throughput, (uint32_t)k, suffixes.weight.x, suffixes.weight.y, suffixes.weight.z,
                 (int)suffix);
    }
  }
}

/// Takes the vertices with a glossy lobe out of `y` into `out`.
CASTRAY_INLINE void split_glossy(const KernelScene& scene, Vertices& y, Vertices& out) {
  int kept = 0;
  out.count = 0;
  for (int i = 0; i < y.count; i += width) {
    const Mask active = first_lanes(y.count - i);
    const Uint record = select(active, load(y.material + i) & 0x7fffffffu, Uint(0u));
    const Mask glossy = active & has_traits(scene, record, trait_directional | trait_shareable);
    compress_vertices(out, out.count, glossy, y, i);
    compress_vertices(y, kept, active & ~glossy, y, i);
    out.count += count(glossy);
    kept += count(active & ~glossy);
  }
  y.count = kept;
}

/// Keeps the lanes of v, which belong to the vertices from i on, with their suffixes.
CASTRAY_INLINE void keep_of_suffixes(VecArray<batch_size>& to, const Vertices& y, int i, const Vec& v) {
  for (int l = 0; l < width && i + l < y.count; ++l) {
    const uint32_t suffix = y.names.slot[i + l] - batch_size;
    to.x[suffix] = lane(v.x, l);
    to.y[suffix] = lane(v.y, l);
    to.z[suffix] = lane(v.z, l);
  }
}

/// One light point for each glossy suffix, without what the suffix makes of it.
template <uint32_t features>
CASTRAY_INLINE void light_glossy(const Context& c, const Vertices& y, Suffixes& suffixes, ShadowRays& out) {
  out.count = 0;
  const LightList& lights = c.scene.lights;
  if (lights.count == 0) return;
  for (int i = 0; i < y.count; i += width) {
    const Mask active = first_lanes(y.count - i);
    const LightPoint point = vertex_light_point<features>(c, y, i, 1);
    const Vec p = load(y.p, i), normal = load(y.normal, i);
    const LightSegment segment = connect_light(point, p);
    const Vec wi = segment.towards * segment.inverse_distance;
    const Mask lit = active & (segment.solid_angle > Float(0.f)) & (dot(normal, wi) > Float(0.f)) &
                     (dot(load(y.shading_normal, i), wi) > Float(0.f));
    const int n = out.count;
    const Segment traced = to_trace<features>(lights, segment, p, normal);
    compress_store(out.o, n, lit, traced.o);
    compress_store(out.d, n, lit, traced.d);
    compress_store(out.radiance, n, lit, point.weight * segment.solid_angle);
    compress_store(out.slot + n, lit, load(y.names.slot + i) + Uint((uint32_t)batch_size));
    out.count += count(lit);
    keep_of_suffixes(suffixes.to_light, y, i, wi);
  }
}

/// The next segment of each glossy suffix, chosen as the suffix's own pixel would.
template <uint32_t features>
CASTRAY_INLINE void scatter_glossy(const Context& c, const Vertices& y, Suffixes& suffixes, Paths& out) {
  const Vec one{Float(1.f), Float(1.f), Float(1.f)};
  out.count = 0;
  for (int i = 0; i < y.count; i += width) {
    const Sequence sequence = sequence_of(y.names, i);
    const Numbers<4> n = draw<4>(c.options.sobol, sequence, direction_block(1));
    const Numbers<2> choice = draw<2>(c.options.sobol, sequence, choice_block(1));
    const Shading shading = shading_of(c.scene, y, i);
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
    compress_names(out.names, k, going, y.names, i);
    compress_store(out.names.light_u + k, going, n.u[2]);
    compress_store(out.names.light_v + k, going, n.u[3]);
    out.count += count(going);
    keep_of_suffixes(suffixes.onward, y, i, wi);
  }
}

/// The BSDF of a glossy suffix, the same in all lanes, and its frame.
struct GlossySuffix {
  Bsdf bsdf;
  Frame frame;
  Vec normal;
};
CASTRAY_INLINE GlossySuffix glossy_suffix(const KernelScene& scene, const Suffixes& suffixes, int i) {
  return {gather_bsdf(scene, Uint(suffixes.material[i]), broadcast_entry(suffixes.albedo, i)),
          make_frame(broadcast_entry(suffixes.shading_normal, i)), broadcast_entry(suffixes.normal, i)};
}

/// Adds what a glossy suffix sends to each pixel: `lit` over the density, reflected from its light point;
/// `arriving` times the stratum, reflected from the next segment, whose direction every x_k could have made
/// y_j take; `emission`.
CASTRAY_INLINE void add_glossy(const KernelScene& scene, const Suffixes& suffixes, int suffix,
                               const Gatherers& tile, const Transfer& t, const Vec& lit, const Vec& arriving,
                               const Vec& emission, Gathered& gathered) {
  const GlossySuffix y = glossy_suffix(scene, suffixes, suffix);
  const Vec p = broadcast_entry(suffixes.p, suffix);
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

/// Every pixel gathers from every suffix of its tile. A suffix that escaped serves the pixel it came from
/// alone.
template <uint32_t features>
CASTRAY_INLINE void gather_suffixes(Context& c, const Vertices& x, const TileBoxes* boxes,
                                    const FarEnds& ends, const Suffixes& suffixes, const Radiance& radiance,
                                    VisibilityScratch& s, Gathered& gathered) {
  const float stratum = stratum_of(c.options);
  for (int tile = 0; tile < c.job.tiles; ++tile) {
    Gatherers gatherers{x, tile * tile_pixels, boxes[tile]};
    for (int j = 0; j < c.options.suffixes; ++j) {
      const int suffix = tile * tile_pixels + j, slot = batch_size + suffix,
                origin = (int)suffixes.origin[suffix];
      const Vec reflected = radiance.at(slot);
      if (!suffixes.landed[suffix]) {
        if (none(max_component(reflected) > Float(0.f))) continue;
        const bool weighted = features & feature_materials;
        gathered.sum.x[origin] += radiance.x[slot] * (weighted ? suffixes.weight.x[suffix] : stratum);
        gathered.sum.y[origin] += radiance.y[slot] * (weighted ? suffixes.weight.y[suffix] : stratum);
        gathered.sum.z[origin] += radiance.z[slot] * (weighted ? suffixes.weight.z[suffix] : stratum);
        continue;
      }
      const bool glossy = (features & feature_materials) && suffixes.glossy[suffix];
      const Vec emitted = broadcast_entry(suffixes.emission, suffix);
      const Vec lit = glossy ? radiance.at(slot + batch_size) : black();
      if (all(max_component(reflected + emitted + lit) <= Float(0.f))) continue;
      Transfer t;
      transfer<features>(c,
                         {broadcast_entry(suffixes.p, suffix), broadcast_entry(suffixes.normal, suffix),
                          origin - gatherers.first},
                         gatherers, ends, s, t);
      const float density = ordered_sum(t.density) / stratum;
      if (!(density > 0)) continue;
      const Vec emission = emitted * Float(1.f / (density + suffixes.light_density[suffix]));
      if constexpr (features & feature_materials) {
        if (glossy) {
          add_glossy(c.scene, suffixes, suffix, gatherers, t, lit * Float(1.f / density),
                     reflected * Float(stratum), emission, gathered);
          continue;
        }
      }
      add_scaled<features>(gathered, gatherers.first, t, fma(reflected, Float(1.f / density), emission));
    }
  }
}

}  // namespace castray::CASTRAY_ISA
