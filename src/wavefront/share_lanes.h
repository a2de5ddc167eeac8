#pragma once

#include "wavefront/follow_lanes.h"
#include "wavefront/glossy_suffixes_lanes.h"
#include "wavefront/start_suffixes_lanes.h"

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

/// Follows the glossy suffixes with the unit weight that leaves what they reflect to each pixel.
template <class Geometry, uint32_t features>
CASTRAY_STAGE void follow_glossy(Context& c, Scratch& s) {
  if (s.glossy.count == 0 || !may_have_edges(c.options, 3)) return;
  light_glossy<Geometry, features>(c, s.glossy, s.suffixes, s.shadow_rays);
  add_unblocked<Geometry>(c, s.shadow_rays, s.radiance);
  scatter_glossy<features>(c, s.glossy, s.suffixes, s.paths);
  closest<Geometry>(c, s.paths, false, s.hits);
  surfaces<Geometry, features, false>(c, s.paths, s.hits, false, s.vertices, s.radiance);
  follow<Geometry, features>(c, s, s.vertices, 2, first_roulette_of_suffixes);
}

/// The light that the camera's vertices reflect, gathered tile by tile.
template <class Geometry, uint32_t features>
CASTRAY_STAGE void share(Context& c, Scratch& s) {
  const int n = c.job.tiles * tile_pixels;
  for (int i = 0; i < n; ++i) s.gathered.sum.x[i] = s.gathered.sum.y[i] = s.gathered.sum.z[i] = 0;
  if constexpr (features & feature_materials) {
    split_unshareable(c.scene, s.camera, s.vertices);
    if (s.vertices.count > 0) follow<Geometry, features>(c, s, s.vertices, 0, first_roulette_vertex);
  }
  for (int tile = 0; tile < c.job.tiles; ++tile)
    bound_tile(s.camera, tile * tile_pixels, Geometry::has_many_blockers, s.boxes[tile]);
  gather_light<Geometry, features>(c, s.camera, s.boxes, s.visibility, s.gathered);
  add_gathered_to_direct<features>(c, s);
  start_suffixes<features>(c, s.camera, s.suffixes, s.paths);
  closest<Geometry>(c, s.paths, false, s.hits);
  surfaces<Geometry, features, false>(c, s.paths, s.hits, false, s.suffixes.y, s.radiance);
  keep_suffix_ends(c, features & feature_detail, s.suffixes);
  if constexpr (features & feature_materials) {
    split_suffixes(c.scene, s.suffixes, s.glossy, s.vertices);
    follow<Geometry, features>(c, s, s.vertices, 1, first_roulette_of_suffixes);
    follow_glossy<Geometry, features>(c, s);
  } else {
    follow<Geometry, features>(c, s, s.suffixes.y, 1, first_roulette_of_suffixes);
  }
  gather_suffixes<Geometry, features>(c, s.camera, s.boxes, s.suffixes, s.radiance, s.visibility, s.gathered);
  for (int i = 0; i < n; i += width) store(s.radiance, i, load(s.radiance, i) + reflected<features>(s, i));
}

}  // namespace castray::CASTRAY_ISA
