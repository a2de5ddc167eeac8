#pragma once

#include "wavefront/follow_lanes.h"
#include "wavefront/glossy_suffixes_lanes.h"
#include "wavefront/start_suffixes_lanes.h"

// Paths shared by the pixels of a tile (after Bekaert, Sbert and Halton 2002).
//
// A suffix starts at one of the tile's camera vertices x_k: one BSDF sample is traced to a point y_j, and
// the radiance that leaves y_j is estimated once. Every camera vertex x_i of the tile then gathers from
// every y_j. With w_ij = f cos cos' V / |x_i - y_j|^2, and p_kj the pdf, per area, with which BSDF
// sampling at x_k finds y_j (it has V in it, as that depends on k), the balance heuristic over all
// possible origins x_k gives pixel i
//
//     L_j w_ij m / sum_k p_kj,
//
// where m is the stratum: pixels per suffix; where not all x_k start as many suffixes, p_kj is times their
// number over the mean. Light points are shared in the same way. Emission at y_j is found by suffixes and by
// light points, so MIS weights it.
//
// Diffuse and rough y_j are shared. Mirrors and glass are not: there suffixes go on as private paths of
// their own pixels. Where the camera sees a surface that does not gather (see gathers), x_i is the first
// vertex of the pixel's own path on one that does; these x_i share among themselves, as they lie elsewhere
// than those that the camera sees.

namespace castray::CASTRAY_ISA {

/// Follows glossy suffixes beyond y_j with a throughput of 1: each pixel applies the BSDF of y_j when it
/// gathers.
template <class Geometry, uint32_t features>
CASTRAY_STAGE void follow_glossy(Context& c, Scratch& s) {
  if (s.glossy.count == 0 || !may_have_edges(c.options, 3)) return;
  light_glossy<Geometry>(c, s.glossy, s.suffixes, s.shadow_rays, s.radiance);
  scatter_glossy<features>(c, s.glossy, s.suffixes, s.paths);
  closest<Geometry>(c, s.paths, false, s.hits);
  absorb<Geometry>(c, s.hits, false, s.paths);
  surfaces<Geometry, features, true>(c, s.paths, s.hits, false, s.vertices, s.radiance);
  keep_found_light(c, features & feature_detail, s.paths, s.hits, s.vertices, s.suffixes);
  follow<Geometry, features>(c, s, s.vertices, 2, first_roulette_of_suffixes);
}

/// Lights without size: each of the vertices x has a shadow ray of its own. `direct`: the camera sees x.
template <class Geometry, uint32_t features>
CASTRAY_STAGE void light_each_by_deltas(Context& c, Scratch& s, const Vertices& x, bool direct) {
  if (c.scene.lights.deltas.count == 0) return;
  light_deltas<Geometry, features>(c, x, 0, s.shadow_rays);
  add_unblocked<Geometry>(c, s.shadow_rays, s.radiance);
  if (direct) add_unblocked_to_direct(c, s);
}

/// TileBoxes::facing of what the camera sees directly.
template <class Geometry>
CASTRAY_INLINE float facing_seen(const Context& c, const Vertices& x, int tile, const TileBoxes& boxes) {
  const KernelCamera& camera = c.scene.camera;
  if (camera.projection == orthographic_rays || camera.has_lens || boxes.empty) return 0;
  if (!geometry_of<Geometry>(c).may_leave_out(camera.position, boxes.all)) return 0;
  return side_seen(x, tile * tile_pixels);
}

/// Light reflected by vertices x, gathered tile by tile, becomes s.gathered. `direct`: the camera sees x.
/// `guided`: they send rays to caustics.
template <class Geometry, uint32_t features>
CASTRAY_STAGE void gather_all(Context& c, Scratch& s, Vertices& x, bool direct, bool guided = false) {
  const int n = c.job.tiles * tile_pixels;
  for (int i = 0; i < n; ++i) s.gathered.sum.x[i] = s.gathered.sum.y[i] = s.gathered.sum.z[i] = 0;
  for (int tile = 0; tile < c.job.tiles; ++tile) {
    bound_tile(x, tile * tile_pixels, Geometry::has_many_blockers, s.boxes[tile]);
    s.boxes[tile].facing = direct ? facing_seen<Geometry>(c, x, tile, s.boxes[tile]) : 0;
    find_origins(x, tile * tile_pixels, c.scene.lights.environment.shines, (uint32_t)c.options.suffixes,
                 s.suffixes.origins[tile]);
  }
  if constexpr (features & feature_materials)
    if (guided) trace_caustic_rays<Geometry, features>(c, s, x);
  light_each_by_deltas<Geometry, features>(c, s, x, direct);
  gather_light<Geometry, features>(c, x, s.boxes, s.suffixes, s.lights, s.visibility, s.gathered);
  start_suffixes<features>(c, x, guided, s.suffixes, s.paths);
  closest<Geometry>(c, s.paths, false, s.hits);
  gather_environment<Geometry, features>(c, x, s.boxes, s.suffixes, s.paths, s.hits, s.visibility,
                                         s.gathered);
  if (direct) add_gathered_to_direct<features>(c, s);
  absorb<Geometry>(c, s.hits, true, s.paths);
  surfaces<Geometry, features, false>(c, s.paths, s.hits, false, s.suffixes.y, s.radiance);
  keep_suffix_ends(c, features & feature_detail, s.suffixes);
  if (c.scene.lights.cells.first) scale_by_cells(c, s.paths.count, s.hits, s.suffixes);
  if (c.scene.lights.regions.tree) scale_light_density(c, s.paths.count, s.hits, s.lights, s.suffixes);
  if constexpr (features & feature_materials) {
    split_suffixes(c.scene, x, s.suffixes, s.glossy, s.vertices);
    follow<Geometry, features>(c, s, s.vertices, 1, first_roulette_of_suffixes);
    follow_glossy<Geometry, features>(c, s);
  } else {
    follow<Geometry, features>(c, s, s.suffixes.y, 1, first_roulette_of_suffixes);
  }
  gather_suffixes<Geometry, features>(c, x, s.boxes, s.suffixes, s.radiance, s.visibility, s.gathered);
}

CASTRAY_INLINE void leave_suffixes_to_light_paths(const Context& c, uint32_t left) {
  if (!c.left_to_light_paths) return;
  for (int slot = batch_size; slot < Radiance::slots; ++slot) c.left_to_light_paths[slot] = left;
}

/// Follows the camera's paths on mirrors, glass and polished metal, and gathers where these chains end. With
/// a limited depth they would not all have the same depth left, and stay private.
template <class Geometry, uint32_t features>
CASTRAY_STAGE void share_chains(Context& c, Scratch& s) {
  split_chains(c.scene, s.camera, s.vertices);
  if (s.vertices.count == 0) return;
  start_chains(c, s.camera, s.chains);
  follow<Geometry, features>(c, s, s.vertices, 0, first_roulette_vertex,
                             c.options.max_depth == 0 ? &s.chains : nullptr);
  for (uint32_t left = 0; left < 2; ++left) {
    ChainEnds& ends = s.chains.ends[left];
    if (!ends.any) continue;
    leave_suffixes_to_light_paths(c, left);
    const bool guided = left == 0 && c.left_to_light_paths && c.scene.lights.arrivals.tree;
    gather_all<Geometry, features>(c, s, ends.vertices, false, guided);
    for (int i = 0; i < c.job.tiles * tile_pixels; i += width)
      store(s.radiance, i,
            fma_vec(load(ends.vertices.throughput, i), load(s.gathered.sum, i), load(s.radiance, i)));
    s.radiance.clear_suffixes();
  }
  leave_suffixes_to_light_paths(c, 1);
}

/// Light reflected by what the camera sees, shared by the pixels of each tile.
template <class Geometry, uint32_t features>
CASTRAY_STAGE void share(Context& c, Scratch& s) {
  if constexpr (features & feature_materials) share_chains<Geometry, features>(c, s);
  gather_all<Geometry, features>(c, s, s.camera, true);
  for (int i = 0; i < c.job.tiles * tile_pixels; i += width)
    store(s.radiance, i, load(s.radiance, i) + reflected<features>(c, s, i));
}

}  // namespace castray::CASTRAY_ISA
