#pragma once

#include "wavefront/gatherers_lanes.h"

// Where the suffixes of a tile start.

namespace castray::CASTRAY_ISA {

/// The points of a tile at which suffixes may start. The balance heuristic needs the number of suffixes that
/// is expected to start at each: any numbers will do, as long as they depend on the points alone.
struct Origins {
  uint32_t count;               ///< at least 1
  uint32_t entry[tile_pixels];  ///< of the camera's vertices
  /// Whether as many are expected to start at each point. If not, suffix j starts at the first point k with
  /// j + u < end[k] / 65536, where u < 1 is random.
  bool even;
  uint32_t end[tile_pixels];
  alignas(64) float share[tile_pixels];  ///< if not even: by pixel, its expected number over the mean
};

/// The points of the tile from `first` on as origins of so many suffixes: as they come; or, `by_normal`, only
/// those on a surface, and those of like orientation side by side.
///
/// Points whose orientation few others have get more suffixes. A path sampled at one of many points alike
/// serves all of them, so that of n such points each has an error like 1 / (n s), with s suffixes for each;
/// the sum over all points is least, for a given number of suffixes, where s is in proportion to 1 / sqrt(n).
void find_origins(const Vertices& x, int first, bool by_normal, uint32_t suffixes, Origins& origins);

/// Of the points of origins that are not even, the first that ends beyond a place.
CASTRAY_INLINE Uint point_at(const Origins& origins, Uint place) {
  Uint point(0u);
  for (uint32_t step = tile_pixels / 2; step > 0; step /= 2) {
    const Uint next = point + Uint(step);
    const Uint last = select(next < Uint(origins.count), next, Uint(1u)) - Uint(1u);
    point = select((next < Uint(origins.count)) & ~(place < gather(origins.end, last)), next, point);
  }
  return point;
}

/// The density with which a suffix finds a sender, times their number over that of origins. `density`: with
/// which one finds it that starts at each point of the tile.
CASTRAY_INLINE float found_from(const Origins& origins, const Float (&density)[tile_vectors]) {
  if (origins.even) return ordered_sum(density);
  Float found[tile_vectors];
  for (int i = 0; i < tile_vectors; ++i) found[i] = density[i] * load(origins.share + i * width);
  return ordered_sum(found);
}

}  // namespace castray::CASTRAY_ISA
