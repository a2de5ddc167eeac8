#pragma once

#include "kernels/shaft.h"
#include "kernels/stages.h"

// Paths shared by the pixels of a tile (after Bekaert, Sbert and Halton 2002).
//
// From some of a tile's camera hits x_k one bounce is traced to a point y_j, where the light that leaves is
// estimated once; every x_i of the tile then gathers from every y_j. With q_ij = cos(x_i) cos(y_j) V_ij /
// |x_i - y_j|^2, which is pi times the density in area of x_i's cosine sampling at y_j, the balance heuristic
// over all x_k that could have been the origin gives pixel i
//
//     albedo_i L_j q_ij m / sum_k q_kj,
//
// m the number of pixels among which each origin was chosen uniformly. Light points are shared the same way,
// without a denominator: their density does not depend on the pixel.

namespace castray::CASTRAY_ISA {

/// The points of one tile that gather: entries first to first + 63 of the camera's vertices.
struct Gatherers {
  const Vertices& x;
  int first;
};

/// The bounds of a tile's points; empty tiles have a box without extent at the origin.
CASTRAY_INLINE Box bounds_of(const Gatherers& tile) {
  const float* axes[3] = {tile.x.p.x, tile.x.p.y, tile.x.p.z};
  Box box{};
  Mask valid[tile_pixels / width];
  uint32_t found = 0;
  for (int i = 0; i < tile_pixels; i += width) {
    valid[i / width] = length_squared(load(tile.x.normal, tile.first + i)) > Float(0.f);
    found |= bits(valid[i / width]);
  }
  if (!found) return box;
  for (int axis = 0; axis < 3; ++axis) {
    Float low(__builtin_inff()), high(-__builtin_inff());
    for (int i = 0; i < tile_pixels; i += width) {
      const Float p = load(axes[axis] + tile.first + i);
      low = select(valid[i / width], min(low, p), low);
      high = select(valid[i / width], max(high, p), high);
    }
    float l = lane(low, 0), h = lane(high, 0);
    for (int k = 1; k < width; ++k) {
      l = lane(low, k) < l ? lane(low, k) : l;
      h = lane(high, k) > h ? lane(high, k) : h;
    }
    box.center[axis] = 0.5f * (l + h);
    box.half[axis] = 0.5f * (h - l) * (1 + 0x1p-20f) + 0x1p-24f;
  }
  return box;
}

/// The sum of 64 values in an order that does not depend on the width: 16 strided sums, then halves onto
/// halves.
CASTRAY_INLINE float ordered_sum(const Float (&value)[tile_pixels / width]) {
  constexpr int stride = 16 / width;
  alignas(64) float sum[16];
  for (int s = 0; s < stride; ++s) {
    Float strided = value[s];
    for (int i = s + stride; i < tile_pixels / width; i += stride) strided += value[i];
    store(sum + s * width, strided);
  }
  for (int half = 8; half > 0; half /= 2)
    for (int i = 0; i < half; ++i) sum[i] += sum[i + half];
  return sum[0];
}

/// A point that sends light to the tile.
struct Sender {
  Vec p, normal;
};

/// q for all pixels of a tile; `own` is the pixel that certainly sees the sender, or -1.
CASTRAY_INLINE void transfer(const Sender& y, const Gatherers& tile, const Shaft& shaft, int own,
                             Float (&q)[tile_pixels / width]) {
  for (int i = 0; i < tile_pixels; i += width) {
    const Vec d = load(tile.x.p, tile.first + i) - y.p;
    const Float cos_y = max(dot(y.normal, d), Float(0.f));
    const Float cos_x = max(-dot(load(tile.x.normal, tile.first + i), d), Float(0.f));
    const Float distance2 = max(length_squared(d), Float(0x1p-60f));
    Float value = cos_x * cos_y / (distance2 * distance2);
    if (shaft.count > 0) {
      Mask hidden(false);
      for (int b = 0; b < shaft.count; ++b) hidden = hidden | hides(shaft, b, d);
      const Mask is_own = Uint((uint32_t)i) + lane_index() == Uint((uint32_t)own);
      value = select(hidden & ~is_own, Float(0.f), value);
    }
    q[i / width] = value;
  }
}

/// Light that the pixels of a job have gathered, before their albedo.
struct Gathered {
  VecArray<batch_size> sum;
};

CASTRAY_INLINE void add_scaled(Gathered& gathered, int first, const Float (&q)[tile_pixels / width],
                               const Vec& scale) {
  for (int i = 0; i < tile_pixels; i += width)
    store(gathered.sum, first + i, fma(scale, q[i / width], load(gathered.sum, first + i)));
}

CASTRAY_INLINE uint32_t tile_key(const Context& c, int tile) {
  const uint32_t key = hash_once(
      hash_once(hash_once(c.options.seed, 0x7411u), (uint32_t)(c.job.grid_x + tile)), (uint32_t)c.job.grid_y);
  return lane(with_epoch(Uint(key), c.job.sample), 0);
}

/// Place `item` of `count` (a power of two) in the sequence of a tile: each pass uses the next `count`
/// indices, in an order of its own.
CASTRAY_INLINE uint32_t tile_index(uint32_t key, uint64_t sample, uint32_t item, uint32_t count) {
  const uint32_t order = hash_once(key, (uint32_t)sample);
  uint32_t v = item ^ order;
  v = v * ((order >> 8) | 1u);
  v ^= (v & (count - 1)) >> 2;
  v = v * ((order >> 16) | 1u);
  return ((uint32_t)sample * count + ((v + (order >> 24)) & (count - 1))) & ((1u << index_bits) - 1);
}

/// Light points shared by each tile.
CASTRAY_INLINE void gather_light(Context& c, const Vertices& x, const Box* boxes, Shaft& shaft,
                                 Gathered& gathered) {
  if (c.scene.lights.count == 0) return;
  const int points = c.options.light_points;
  for (int tile = 0; tile < c.job.tiles; ++tile) {
    const Gatherers gatherers{x, tile * tile_pixels};
    const uint32_t key = tile_key(c, tile);
    for (int first = 0; first < points; first += width) {
      Uint index(0u);
      for (int l = 0; l < width; ++l)
        index = select(lane_index() == Uint((uint32_t)l),
                       Uint(tile_index(key, c.job.sample, (uint32_t)(first + l), (uint32_t)points)), index);
      const Numbers<4> n = draw<4>(c.options.sobol, {Uint(key), index}, 0);
      LightPoint point = sample_light(c.scene.lights, n.u[0], n.u[1], n.u[2]);
      const Mask back = point.two_sided & (n.u[3] < Float(0.5f));
      point.normal = select(back, -point.normal, point.normal);
      point.weight =
          point.weight * select(point.two_sided, Float(2.f), Float(1.f)) * Float(1.f / (pi * (float)points));
      const Vec p = fma(point.normal, point.error, point.p);
      for (int l = 0; l < width && first + l < points; ++l) {
        const Sender y{
            {Float(lane(p.x, l)), Float(lane(p.y, l)), Float(lane(p.z, l))},
            {Float(lane(point.normal.x, l)), Float(lane(point.normal.y, l)), Float(lane(point.normal.z, l))}};
        make_shaft(c.scene.blocker_fields, y.p, boxes[tile], shaft);
        Float q[tile_pixels / width];
        transfer(y, gatherers, shaft, -1, q);
        add_scaled(
            gathered, gatherers.first, q,
            {Float(lane(point.weight.x, l)), Float(lane(point.weight.y, l)), Float(lane(point.weight.z, l))});
      }
    }
    c.rays += (uint64_t)(points * tile_pixels);
  }
}

/// The suffixes of a job: suffix j of tile t has slot batch_size + 64 t + j.
struct Suffixes {
  VecArray<batch_size> p, normal;           ///< y; no normal: there is none
  alignas(64) uint32_t origin[batch_size];  ///< entry of the camera vertex it started from
};

/// One bounce from one pixel of each stratum.
CASTRAY_INLINE void start_suffixes(const Context& c, const Vertices& x, Suffixes& suffixes, Paths& out) {
  const uint32_t per_tile = (uint32_t)c.options.suffixes, stratum = tile_pixels / per_tile;
  out.count = 0;
  for (int tile = 0; tile < c.job.tiles; ++tile) {
    const uint32_t key = tile_key(c, tile);
    for (uint32_t j = 0; j < per_tile; ++j) {
      const uint32_t choice = hash_once(hash_once(key, (uint32_t)c.job.sample), j + 0x51u);
      const uint32_t entry =
          (uint32_t)(tile * tile_pixels) + j * stratum + (uint32_t)(((uint64_t)choice * stratum) >> 32);
      const int suffix = tile * tile_pixels + (int)j;
      suffixes.normal.x[suffix] = suffixes.normal.y[suffix] = suffixes.normal.z[suffix] = 0;
      suffixes.origin[suffix] = entry;
      if (x.normal.x[entry] == 0 && x.normal.y[entry] == 0 && x.normal.z[entry] == 0) continue;
      out.slot[out.count] = (uint32_t)(batch_size + suffix);
      out.key[out.count] = key;
      out.index[out.count] = tile_index(key, c.job.sample, j, per_tile);
      ++out.count;
    }
  }
  for (int i = 0; i < out.count; i += width) {
    const Uint suffix =
        select(first_lanes(out.count - i), load(out.slot + i) - Uint((uint32_t)batch_size), Uint(0u));
    const Uint entry = gather(suffixes.origin, suffix);
    const Numbers<4> n = draw<4>(c.options.sobol, load_sequence(out.key, out.index, i), direction_block(0));
    const Vec normal{gather(x.normal.x, entry), gather(x.normal.y, entry), gather(x.normal.z, entry)};
    store(out.o, i, Vec{gather(x.p.x, entry), gather(x.p.y, entry), gather(x.p.z, entry)});
    store(out.d, i, cosine_direction(normal, n.u[0], n.u[1]));
    store(out.throughput, i, Vec{Float(1.f), Float(1.f), Float(1.f)});
    store(out.light_u + i, n.u[2]);
    store(out.light_v + i, n.u[3]);
  }
}

/// Keeps where the suffixes have landed.
CASTRAY_INLINE void keep_suffixes(const Vertices& y, Suffixes& suffixes) {
  for (int i = 0; i < y.count; ++i) {
    const uint32_t suffix = y.slot[i] - batch_size;
    suffixes.p.x[suffix] = y.p.x[i];
    suffixes.p.y[suffix] = y.p.y[i];
    suffixes.p.z[suffix] = y.p.z[i];
    suffixes.normal.x[suffix] = y.normal.x[i];
    suffixes.normal.y[suffix] = y.normal.y[i];
    suffixes.normal.z[suffix] = y.normal.z[i];
  }
}

/// Every pixel gathers from every suffix of its tile. A suffix that escaped serves the pixel it came from
/// alone.
CASTRAY_INLINE void gather_suffixes(Context& c, const Vertices& x, const Box* boxes, const Suffixes& suffixes,
                                    const Radiance& radiance, Shaft& shaft, Gathered& gathered) {
  const float stratum = (float)(tile_pixels / c.options.suffixes);
  for (int tile = 0; tile < c.job.tiles; ++tile) {
    const Gatherers gatherers{x, tile * tile_pixels};
    for (int j = 0; j < c.options.suffixes; ++j) {
      const int suffix = tile * tile_pixels + j, slot = batch_size + suffix;
      const int origin = (int)suffixes.origin[suffix];
      const float r = radiance.x[slot], g = radiance.y[slot], b = radiance.z[slot];
      if (!(r > 0 || g > 0 || b > 0)) continue;
      const Sender y{{Float(suffixes.p.x[suffix]), Float(suffixes.p.y[suffix]), Float(suffixes.p.z[suffix])},
                     {Float(suffixes.normal.x[suffix]), Float(suffixes.normal.y[suffix]),
                      Float(suffixes.normal.z[suffix])}};
      if (none(length_squared(y.normal) > Float(0.f))) {
        gathered.sum.x[origin] += r * stratum;
        gathered.sum.y[origin] += g * stratum;
        gathered.sum.z[origin] += b * stratum;
        continue;
      }
      make_shaft(c.scene.blocker_fields, y.p, boxes[tile], shaft);
      Float q[tile_pixels / width];
      transfer(y, gatherers, shaft, origin - gatherers.first, q);
      const float total = ordered_sum(q);
      if (!(total > 0)) continue;
      const float scale = stratum / total;
      add_scaled(gathered, gatherers.first, q, {Float(r * scale), Float(g * scale), Float(b * scale)});
      c.rays += tile_pixels;
    }
  }
}

}  // namespace castray::CASTRAY_ISA
