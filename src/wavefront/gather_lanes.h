#pragma once

#include "geometry/bvh_shaft_lanes.h"
#include "wavefront/stages_lanes.h"

// What the pixels of a tile get from one point that sends light to them.

namespace castray::CASTRAY_ISA {

inline constexpr int tile_vectors = tile_pixels / width;

/// A tile's points are also bounded in parts, the same for every width.
inline constexpr int tile_parts = 4, part_pixels = tile_pixels / tile_parts,
                     part_vectors = part_pixels / width;

/// The bounds of a tile's points, and of each 16 of them.
struct TileBoxes {
  Box all, part[tile_parts];
};

/// The points of one tile that gather: entries first to first + 63 of the camera's vertices.
struct Gatherers {
  const Vertices& x;
  int first;
  const TileBoxes& boxes;
  ShaftBudget budget{};
};

/// A point that sends light to the tile, on the side of its normal. `own`: the pixel of the tile that
/// certainly sees it, or -1.
struct Sender {
  Vec p, normal;
  int own;
};

/// For each pixel of a tile: f cos cos' V / |x - y|^2, and the density, per area at y, of x's BSDF sampling
/// finding y. Where all materials are diffuse, `weight` is not filled: it is the density times the albedo.
struct Transfer {
  Float density[tile_vectors];
  Vec weight[tile_vectors];
};

/// The sum of 64 values in an order that does not depend on the width: 16 strided sums, then halves onto
/// halves.
CASTRAY_INLINE float ordered_sum(const Float (&value)[tile_vectors]) {
  constexpr int stride = 16 / width;
  alignas(64) float sum[16];
  for (int s = 0; s < stride; ++s) {
    Float strided = value[s];
    for (int i = s + stride; i < tile_vectors; i += stride) strided += value[i];
    store(sum + s * width, strided);
  }
  for (int half = 8; half > 0; half /= 2)
    for (int i = 0; i < half; ++i) sum[i] += sum[i + half];
  return sum[0];
}

/// The bounds of the points of some entries; without any the box has no extent and is at the origin.
template <int vectors>
CASTRAY_INLINE Box bounds_of(const Vertices& x, int first) {
  const float* axes[3] = {x.p.x, x.p.y, x.p.z};
  Box box{};
  Mask valid[vectors];
  uint32_t found = 0;
  for (int i = 0; i < vectors; ++i) {
    valid[i] = length_squared(load(x.normal, first + i * width)) > Float(0.f);
    found |= bits(valid[i]);
  }
  if (!found) return box;
  for (int axis = 0; axis < 3; ++axis) {
    Float low(__builtin_inff()), high(-__builtin_inff());
    for (int i = 0; i < vectors; ++i) {
      const Float p = load(axes[axis] + first + i * width);
      low = select(valid[i], min(low, p), low);
      high = select(valid[i], max(high, p), high);
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

/// `in_parts`: whether the parts' bounds are wanted too.
CASTRAY_INLINE void bound_tile(const Vertices& x, int first, bool in_parts, TileBoxes& boxes) {
  boxes.all = bounds_of<tile_vectors>(x, first);
  if (!in_parts) return;
  for (int i = 0; i < tile_parts; ++i) boxes.part[i] = bounds_of<part_vectors>(x, first + i * part_pixels);
}

/// Room for visibility tests.
struct VisibilityScratch {
  Shaft shaft;
  alignas(64) uint32_t pyramids[max_blockers + 16];
  VecArray<capacity> o, d;
  alignas(64) UintArray pixel;
  alignas(64) uint8_t blocked[capacity];
};

CASTRAY_INLINE void hide(Transfer& t, int i, Mask hidden, bool weights) {
  t.density[i] = select(hidden, Float(0.f), t.density[i]);
  if (weights) t.weight[i] = select(hidden, black(), t.weight[i]);
}

/// Takes out what is hidden from the sender, by a ray for each pixel.
CASTRAY_INLINE void hide_by_rays(Context& c, const Sender& y, const Gatherers& tile, const FarEnds& ends,
                                 VisibilityScratch& s, bool weights, Transfer& t) {
  int n = 0;
  for (int i = 0; i < tile_vectors; ++i) {
    const Uint pixel = Uint((uint32_t)(i * width)) + lane_index();
    const Mask open = (t.density[i] > Float(0.f)) & ~(pixel == Uint((uint32_t)y.own));
    compress_store(s.o, n, open, y.p);
    const int entry = tile.first + i * width;
    compress_store(s.d, n, open,
                   far_end<feature_bvh>(load(tile.x.p, entry), load(tile.x.normal, entry), y.p) - y.p);
    compress_store(s.pixel + n, open, pixel);
    n += count(open);
  }
  bvh_occluded(c.scene.bvh, {s.o.x, s.o.y, s.o.z, s.d.x, s.d.y, s.d.z, ends.one, s.blocked, (uint32_t)n});
  uint64_t hidden = 0;
  for (int k = 0; k < n; ++k) hidden |= (uint64_t)(s.blocked[k] ? 1 : 0) << s.pixel[k];
  for (int i = 0; i < tile_vectors; ++i)
    hide(t, i, mask_of_bits((uint32_t)(hidden >> (i * width)) & (uint32_t)((1ull << width) - 1)), weights);
}

/// From so many pyramids on it pays to choose those that matter to each part of a tile.
inline constexpr int few_pyramids = 16;

/// Takes out what is hidden from the sender.
template <uint32_t features>
CASTRAY_INLINE void hide_blocked(Context& c, const Sender& y, Gatherers& tile, const FarEnds& ends,
                                 VisibilityScratch& s, Transfer& t) {
  constexpr bool weights = features & feature_materials;
  constexpr int corners = (features & feature_bvh) ? 3 : 4;
  if constexpr (features & feature_bvh) {
    if (!make_shaft(c.scene.bvh, y.p, tile.boxes.all, tile.budget, s.shaft))
      return hide_by_rays(c, y, tile, ends, s, weights, t);
  } else {
    make_shaft(c.scene.blocker_fields, y.p, tile.boxes.all, s.shaft);
  }
  if (s.shaft.count == 0) return;
  const bool choose = (features & feature_bvh) && s.shaft.count > few_pyramids;
  int pyramids = s.shaft.count;
  for (int i = 0; i < tile_vectors; ++i) {
    if (choose && i % part_vectors == 0) {
      const Box& part = tile.boxes.part[i / part_vectors];
      pyramids =
          pyramids_of_part<corners>(s.shaft, broadcast(part.center) - y.p, broadcast(part.half), s.pyramids);
    }
    const Mask open = t.density[i] > Float(0.f);
    if (none(open)) continue;
    const Vec d = load(tile.x.p, tile.first + i * width) - y.p;
    Mask hidden(false);
    for (int b = 0; b < pyramids; ++b) {
      hidden = hidden | hides<corners>(s.shaft, choose ? s.pyramids[b] : (uint32_t)b, d);
      if ((b & 3) == 3 && none(open & ~hidden)) break;
    }
    const Mask own = Uint((uint32_t)(i * width)) + lane_index() == Uint((uint32_t)y.own);
    hide(t, i, hidden & ~own, weights);
  }
}

/// Everything of Transfer but visibility.
template <uint32_t features>
CASTRAY_INLINE void unoccluded_transfer(const Context& c, const Sender& y, const Gatherers& tile,
                                        Transfer& t) {
  for (int i = 0; i < tile_vectors; ++i) {
    const int entry = tile.first + i * width;
    const Vec d = load(tile.x.p, entry) - y.p, normal = load(tile.x.normal, entry);
    const Float distance2 = max(length_squared(d), Float(0x1p-60f));
    const Float cos_y = max(dot(y.normal, d), Float(0.f)), cos_x = max(-dot(normal, d), Float(0.f));
    t.density[i] = cos_x * cos_y / (distance2 * distance2) * Float(1.f / pi);
    if constexpr (features & feature_materials) {
      t.weight[i] = load(tile.x.albedo, entry) * t.density[i];
      const Mask directional =
          has_traits(c.scene, load(tile.x.material + entry) & 0x7fffffffu, trait_directional) &
          (length_squared(normal) > Float(0.f));
      bool other = any(directional);
      if constexpr (features & feature_detail) other = true;
      if (!other) continue;
      const Shading shading = shading_of(c.scene, tile.x, entry);
      const Float inverse = Float(1.f) / sqrt(distance2);
      const Vec wi = d * -inverse, local = to_local(shading.frame, wi);
      const BsdfValue value = evaluate(shading.bsdf, shading.wo, local);
      const Float geometry = cos_y * inverse * inverse * inverse;
      const Mask valid = shading.consistent(wi, local) & (length_squared(normal) > Float(0.f));
      const Mask lanes = (features & feature_detail) ? Mask(true) : directional;
      t.density[i] = select(lanes, select(valid, value.pdf * geometry, Float(0.f)), t.density[i]);
      t.weight[i] = select(lanes, select(valid, value.f_cos * geometry, black()), t.weight[i]);
    }
  }
}

template <uint32_t features>
CASTRAY_INLINE void transfer(Context& c, const Sender& y, Gatherers& tile, const FarEnds& ends,
                             VisibilityScratch& s, Transfer& t) {
  unoccluded_transfer<features>(c, y, tile, t);
  hide_blocked<features>(c, y, tile, ends, s, t);
  c.rays += tile_pixels;
}

/// Light that the pixels of a job have gathered; before their albedo, where all materials are diffuse.
struct Gathered {
  VecArray<batch_size> sum;
};

template <uint32_t features>
CASTRAY_INLINE void add_scaled(Gathered& gathered, int first, const Transfer& t, const Vec& radiance) {
  for (int i = 0; i < tile_vectors; ++i) {
    const Vec before = load(gathered.sum, first + i * width);
    const Vec more = (features & feature_materials) ? fma_vec(radiance, t.weight[i], before)
                                                    : fma(radiance, t.density[i], before);
    store(gathered.sum, first + i * width, more);
  }
}

}  // namespace castray::CASTRAY_ISA
