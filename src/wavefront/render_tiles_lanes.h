#pragma once

#include "wavefront/first_hits_lanes.h"
#include "wavefront/reuse_lanes.h"
#include "wavefront/stages_lanes.h"

// A job from camera rays to radiance: every pixel by itself, or the pixels of each tile together.

namespace castray::CASTRAY_ISA {

struct Scratch {
  FarEnds ends;
  Paths paths;
  Hits hits;
  Vertices camera, vertices, glossy;
  ShadowRays shadow_rays;
  Radiance radiance;
  Suffixes suffixes;
  Gathered gathered;
  VisibilityScratch visibility;
  TileBoxes boxes[max_tiles];
  VecArray<batch_size> direct;  ///< radiance of each pixel without what its first bounce brings
};

/// Automatic roulette starts at this vertex; the same as first_roulette_vertex of the reference.
inline constexpr uint32_t first_roulette = 2;
/// A suffix serves many pixels, so it is worth following further.
inline constexpr uint32_t first_roulette_of_suffixes = 4;

CASTRAY_INLINE bool may_have_edges(const KernelOptions& options, uint32_t edges) {
  return options.max_depth == 0 || edges <= options.max_depth;
}

CASTRAY_INLINE bool clamps_indirect(const KernelOptions& options) {
  return options.most_indirect < __builtin_inff();
}

/// What the tile's light points and suffixes have brought to pixels i to i + width - 1.
template <uint32_t features>
CASTRAY_INLINE Vec reflected(const Scratch& s, int i) {
  const Vec sum = load(s.gathered.sum, i);
  return (features & feature_materials) ? sum : sum * load(s.camera.albedo, i);
}

/// Keeps the radiance so far, and what is gathered so far, as the direct part of each sample.
CASTRAY_INLINE void keep_direct(const Context& c, Scratch& s) {
  if (!clamps_indirect(c.options)) return;
  for (int i = 0; i < c.job.tiles * tile_pixels; i += width) store(s.direct, i, load(s.radiance, i));
}
template <uint32_t features>
CASTRAY_INLINE void add_gathered_to_direct(const Context& c, Scratch& s) {
  if (!clamps_indirect(c.options)) return;
  for (int i = 0; i < c.job.tiles * tile_pixels; i += width)
    store(s.direct, i, load(s.direct, i) + reflected<features>(s, i));
}

/// Scales the rest of each sample down to the greatest component that it may have.
CASTRAY_INLINE void clamp_indirect(const Context& c, Scratch& s) {
  if (!clamps_indirect(c.options)) return;
  const Float most(c.options.most_indirect);
  for (int i = 0; i < c.job.tiles * tile_pixels; i += width) {
    const Vec whole = load(s.radiance, i), direct = load(s.direct, i), indirect = whole - direct;
    const Float brightest = max_component(indirect);
    store(s.radiance, i, select(brightest > most, fma(indirect, most / brightest, direct), whole));
  }
}

/// Lights the vertices, which are number `vertex` of their paths, and follows the paths to their ends.
template <uint32_t features>
CASTRAY_INLINE void follow(Context& c, Scratch& s, Vertices& vertices, uint32_t vertex, uint32_t roulette) {
  const bool may_find_lights = c.options.mis || (features & feature_materials);
  Vertices* current = &vertices;
  for (; may_have_edges(c.options, vertex + 2); ++vertex) {
    light<features>(c, *current, vertex, s.shadow_rays);
    add_unblocked<features>(c, s.ends, s.shadow_rays, s.radiance);
    if (vertex == 0) keep_direct(c, s);
    scatter<features>(c, *current, vertex, roulette, s.paths);
    if (s.paths.count == 0) return;
    closest<features>(c, s.paths, s.ends, false, s.hits);
    surfaces<features, false>(c, s.paths, s.hits, may_find_lights, s.vertices, s.radiance);
    current = &s.vertices;
  }
}

/// Takes the vertices that cannot share, whose materials are not shareable, out of `camera` into `out`.
CASTRAY_INLINE void split_unshareable(const KernelScene& scene, Vertices& camera, Vertices& out) {
  out.count = 0;
  for (int i = 0; i < camera.count; i += width) {
    const Uint record = load(camera.material + i) & 0x7fffffffu;
    const Vec normal = load(camera.normal, i);
    const Mask alone = first_lanes(camera.count - i) & (length_squared(normal) > Float(0.f)) &
                       ~has_traits(scene, record, trait_shareable);
    if (none(alone)) continue;
    compress_vertices(out, out.count, alone, camera, i);
    out.count += count(alone);
    store(camera.normal, i, select(alone, black(), normal));
    store(camera.albedo, i, select(alone, black(), load(camera.albedo, i)));
  }
}

/// Follows the glossy suffixes with the unit weight that leaves what they reflect to each pixel.
template <uint32_t features>
CASTRAY_INLINE void follow_glossy(Context& c, Scratch& s) {
  if (s.glossy.count == 0 || !may_have_edges(c.options, 3)) return;
  light_glossy<features>(c, s.glossy, s.suffixes, s.shadow_rays);
  add_unblocked<features>(c, s.ends, s.shadow_rays, s.radiance);
  scatter_glossy<features>(c, s.glossy, s.suffixes, s.paths);
  closest<features>(c, s.paths, s.ends, false, s.hits);
  surfaces<features, false>(c, s.paths, s.hits, false, s.vertices, s.radiance);
  follow<features>(c, s, s.vertices, 2, first_roulette_of_suffixes);
}

/// The light that the camera's vertices reflect, gathered tile by tile.
template <uint32_t features>
CASTRAY_INLINE void share(Context& c, Scratch& s) {
  const int n = c.job.tiles * tile_pixels;
  for (int i = 0; i < n; ++i) s.gathered.sum.x[i] = s.gathered.sum.y[i] = s.gathered.sum.z[i] = 0;
  if constexpr (features & feature_materials) {
    split_unshareable(c.scene, s.camera, s.vertices);
    if (s.vertices.count > 0) follow<features>(c, s, s.vertices, 0, first_roulette);
  }
  for (int tile = 0; tile < c.job.tiles; ++tile)
    bound_tile(s.camera, tile * tile_pixels, features & feature_bvh, s.boxes[tile]);
  gather_light<features>(c, s.camera, s.boxes, s.ends, s.visibility, s.gathered);
  add_gathered_to_direct<features>(c, s);
  start_suffixes<features>(c, s.camera, s.suffixes, s.paths);
  closest<features>(c, s.paths, s.ends, false, s.hits);
  surfaces<features, false>(c, s.paths, s.hits, false, s.vertices, s.radiance);
  keep_suffixes<features>(c, s.vertices, s.suffixes);
  if constexpr (features & feature_materials) split_glossy(c.scene, s.vertices, s.glossy);
  follow<features>(c, s, s.vertices, 1, first_roulette_of_suffixes);
  if constexpr (features & feature_materials) follow_glossy<features>(c, s);
  gather_suffixes<features>(c, s.camera, s.boxes, s.ends, s.suffixes, s.radiance, s.visibility, s.gathered);
  for (int i = 0; i < n; i += width) store(s.radiance, i, load(s.radiance, i) + reflected<features>(s, i));
}

template <uint32_t features>
CASTRAY_INLINE void render_tiles(const KernelScene& scene, const KernelOptions& options, const TileJob& job,
                                 void* scratch, TileResult& result) {
  Scratch& s = *static_cast<Scratch*>(scratch);
  Context c{scene, options, job};
  fill(s.ends);
  s.radiance.clear();
  place_pixels(c, result);
  camera_rays(c, result, s.paths);
  const FirstHits& first = scene.first_hits;
  if (first.known)
    recall_first_hits(first, result, s.paths.count, s.hits);
  else
    closest<features>(c, s.paths, s.ends, true, s.hits);
  if (first.t && !first.known) return keep_first_hits(first, result, s.paths.count, s.hits);
  surfaces<features, true>(c, s.paths, s.hits, true, s.camera, s.radiance);
  keep_direct(c, s);
  if (options.suffixes > 0 && may_have_edges(options, 2))
    share<features>(c, s);
  else
    follow<features>(c, s, s.camera, 0, first_roulette);
  clamp_indirect(c, s);
  for (int i = 0; i < job.tiles * tile_pixels; ++i) {
    result.radiance[0][i] = s.radiance.x[i];
    result.radiance[1][i] = s.radiance.y[i];
    result.radiance[2][i] = s.radiance.z[i];
  }
  result.rays += c.rays;
}

}  // namespace castray::CASTRAY_ISA
