#pragma once

#include "wavefront/transfer_lanes.h"

namespace castray::CASTRAY_ISA {

/// Memory for visibility tests.
struct VisibilityScratch {
  Shaft shaft;
  alignas(64) uint32_t pyramids[max_blockers + 16];
  VecArray<capacity> o, d;
  alignas(64) UintArray pixel;
  alignas(64) FloatArray kept;  ///< as in ShadowBatch
  alignas(64) uint8_t blocked[capacity];
};

CASTRAY_INLINE void hide(Transfer& t, int i, Mask hidden, bool weights) {
  t.density[i] = select(hidden, Float(0.f), t.density[i]);
  if (weights) t.weight[i] = select(hidden, black(), t.weight[i]);
}

CASTRAY_INLINE NearApex apex_of(const Sender& y, const Box& /*tile*/) { return {y.p}; }
CASTRAY_INLINE FarApex apex_of(const FarSender& y, const Box& tile) { return {y.w, broadcast(tile.center)}; }

/// Which triangles need no test between a sender and a tile: see TileBoxes::facing.
template <class Geometry>
CASTRAY_INLINE float facing_of(const Geometry& geometry, const Sender& y, const TileBoxes& boxes) {
  if (boxes.facing == 0 || !y.seen) return 0;
  const float p[3] = {lane(y.p.x, 0), lane(y.p.y, 0), lane(y.p.z, 0)};
  return geometry.may_leave_out(p, boxes.all) ? boxes.facing : 0;
}
template <class Geometry>
CASTRAY_INLINE float facing_of(const Geometry&, const FarSender&, const TileBoxes&) {
  return 0;
}

/// The segment to trace between a sender and a point p of a tile.
template <class Geometry>
CASTRAY_INLINE Segment segment_of(const Geometry& geometry, const Sender& y, const Vec& p,
                                  const Vec& normal) {
  return {y.p, geometry.far_end(p, normal, y.p) - y.p};
}
template <class Geometry>
CASTRAY_INLINE Segment segment_of(const Geometry&, const FarSender& y, const Vec& p, const Vec& /*normal*/) {
  return {p, y.w * Float(beyond_scene)};
}

/// Scales what pixels get by what the n shadow rays traced leave of it. The `own` pixel is known not to be
/// occluded.
CASTRAY_INLINE void thin(const VisibilityScratch& s, int n, int own, bool weights, Transfer& t) {
  alignas(64) float kept[tile_pixels];
  for (float& k : kept) k = 1;
  for (int k = 0; k < n; ++k) kept[s.pixel[k]] = s.blocked[k] && (int)s.pixel[k] != own ? 0 : s.kept[k];
  for (int i = 0; i < tile_vectors; ++i) {
    const Float left = load(kept + i * width);
    t.density[i] = t.density[i] * left;
    if (weights) t.weight[i] = t.weight[i] * left;
  }
}

/// Scales what pixels get by what windows leave of colours on the n segments.
template <class Geometry>
inline __attribute__((noinline)) void tint(const Context& c, const VisibilityScratch& s, int n, Transfer& t) {
  Tints tints;
  find_tints<Geometry>(c, s.o, s.d, c.ends.one, n, nullptr, tints);
  VecArray<tile_pixels> left;
  const Float one(1.f);
  for (int i = 0; i < tile_vectors; ++i) store(left, i * width, Vec{one, one, one});
  for (int k = 0; k < n; ++k) {
    left.x[s.pixel[k]] = tints.left.x[k];
    left.y[s.pixel[k]] = tints.left.y[k];
    left.z[s.pixel[k]] = tints.left.z[k];
  }
  for (int i = 0; i < tile_vectors; ++i) t.weight[i] = t.weight[i] * load(left, i * width);
}

/// Visibility of the pixels `asked` by one shadow ray each: all that partial triangles may lie before, as no
/// shaft holds one. They thin the light of the sender's own pixel, too, which found it by chance.
template <class Geometry, class AnySender>
CASTRAY_INLINE void hide_by_rays(Context& c, const AnySender& y, const Gatherers& tile, uint64_t asked,
                                 VisibilityScratch& s, bool weights, Transfer& t) {
  const Geometry geometry = geometry_of<Geometry>(c);
  const bool thins = geometry.thins();
  const Uint known((uint32_t)(thins ? -1 : y.own));
  int n = 0;
  for (int i = 0; i < tile_vectors; ++i) {
    const Uint pixel = Uint((uint32_t)(i * width)) + lane_index();
    const Mask open = lanes_of(asked, i) & (t.density[i] > Float(0.f)) & ~(pixel == known);
    const int entry = tile.first + i * width;
    const Segment traced = segment_of(geometry, y, load(tile.x.p, entry), load(tile.x.normal, entry));
    compress_store(s.o, n, open, traced.o);
    compress_store(s.d, n, open, traced.d);
    compress_store(s.pixel + n, open, pixel);
    n += count(open);
  }
  geometry.occluded({s.o.x, s.o.y, s.o.z, s.d.x, s.d.y, s.d.z, c.ends.one, s.blocked, (uint32_t)n,
                     thins ? s.kept : nullptr});
  c.asked += (uint64_t)n;
  if (weights && has_tints(c)) tint<Geometry>(c, s, n, t);
  if (thins) return thin(s, n, y.own, weights, t);
  uint64_t hidden = 0;
  for (int k = 0; k < n; ++k) hidden |= (uint64_t)(s.blocked[k] ? 1 : 0) << s.pixel[k];
  for (int i = 0; i < tile_vectors; ++i) hide(t, i, lanes_of(hidden, i), weights);
}

/// With more pyramids than this, it pays to select those that meet each part of a tile.
inline constexpr int few_pyramids = 16;

/// Visibility of `pixels` of the tile by the pyramids of the shaft to their box. Returns the pixels that it
/// leaves open: those on the outline of a pyramid, as far as rounding tells.
template <class Geometry, class AnySender>
CASTRAY_INLINE uint64_t hide_by_pyramids(const AnySender& y, const Gatherers& tile, const Box& box,
                                         uint64_t pixels, VisibilityScratch& s, bool weights, Transfer& t) {
  constexpr int corners = Geometry::blocker_corners;
  if (s.shaft.count == 0) return 0;
  const bool choose = Geometry::has_many_blockers && s.shaft.count > few_pyramids;
  const Vec center = broadcast(box.center);
  int pyramids = s.shaft.count;
  uint64_t unsure = 0;
  for (int i = 0; i < tile_vectors; ++i) {
    if (choose && i % part_vectors == 0) {
      const Box& part = tile.boxes.part[i / part_vectors];
      pyramids = pyramids_of_part<corners>(s.shaft, broadcast(part.center) - center, broadcast(part.half),
                                           s.pyramids);
    }
    const Mask open = (t.density[i] > Float(0.f)) & lanes_of(pixels, i);
    if (none(open)) continue;
    const Vec p = load(tile.x.p, tile.first + i * width) - center;
    Float inside(-__builtin_inff());
    for (int b = 0; b < pyramids; ++b) {
      inside = max(inside, hidden_by<corners>(s.shaft, choose ? s.pyramids[b] : (uint32_t)b, p));
      if ((b & 3) == 3 && none(open & (inside < Float(1.f)))) break;
    }
    const Mask hidden = inside >= Float(1.f);
    const Mask own = Uint((uint32_t)(i * width)) + lane_index() == Uint((uint32_t)y.own);
    hide(t, i, open & hidden & ~own, weights);
    unsure |= (uint64_t)bits(open & ~hidden & (inside >= Float(-1.f))) << (i * width);
  }
  return unsure;
}

CASTRAY_INLINE bool any_open(const Transfer& t, uint64_t pixels) {
  Mask open(false);
  for (int i = 0; i < tile_vectors; ++i) open = open | (lanes_of(pixels, i) & (t.density[i] > Float(0.f)));
  return any(open);
}

/// Visibility by a shaft to each group of the tile's points, or by rays where that holds too much.
template <class Geometry, uint32_t features, class AnySender>
CASTRAY_INLINE void hide_blocked(Context& c, const AnySender& y, Gatherers& tile, VisibilityScratch& s,
                                 Transfer& t) {
  constexpr bool weights = features & feature_materials;
  if (!any_open(t, ~0ull)) return;
  const Geometry geometry = geometry_of<Geometry>(c);
  const float facing = facing_of(geometry, y, tile.boxes);
  uint64_t asked = 0;
  for (int g = 0; g < tile.boxes.groups; ++g) {
    const uint64_t pixels = tile.boxes.pixels[g];
    const Box& box = tile.boxes.group[g];
    if (!any_open(t, pixels)) continue;
    const bool fits = geometry.make_shaft(apex_of(y, box), box, tile.budget[g], s.shaft, facing);
    asked |= fits ? hide_by_pyramids<Geometry>(y, tile, box, pixels, s, weights, t) : pixels;
  }
  if (asked) hide_by_rays<Geometry>(c, y, tile, asked, s, weights, t);
}

template <class Geometry, uint32_t features, class AnySender>
CASTRAY_STAGE void transfer(Context& c, const AnySender& y, Gatherers& tile, VisibilityScratch& s,
                            Transfer& t) {
  unoccluded_transfer<features>(c, y, tile, t);
  if constexpr (features & feature_materials)
    if (c.scene.absorbing) dim(c, y, tile, t);
  hide_blocked<Geometry, features>(c, y, tile, s, t);
  c.rays += tile_pixels;
  c.gathered += tile_pixels;
}

}  // namespace castray::CASTRAY_ISA
