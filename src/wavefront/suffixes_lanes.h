#pragma once

#include "wavefront/light_points_lanes.h"
#include "wavefront/origins_lanes.h"

namespace castray::CASTRAY_ISA {

/// Directions from the ends y of glossy suffixes to light, by number of the suffix.
struct LightDirections {
  VecArray<batch_size> w;             ///< unit vectors
  alignas(64) float pdf[batch_size];  ///< with which light sampling at y finds it, per solid angle
};

/// The suffixes of a job: suffix j of tile t is number 64 t + j, and has slot batch_size + its number.
struct Suffixes {
  Origins origins[max_tiles];               ///< by tile
  alignas(64) uint32_t origin[batch_size];  ///< entry of the camera vertex x_k where it started
  alignas(64) uint32_t landed[batch_size];  ///< 1 + its entry in y; 0: it escaped, or was not traced
  VecArray<batch_size> weight;              ///< f cos / pdf at x_k, times the stratum

  Vertices y;                            ///< where suffixes landed
  VecArray<capacity> emission;           ///< of y towards x_k; 0 without MIS
  alignas(64) FloatArray light_density;  ///< pdf of y by light sampling, per area
  alignas(64) UintArray glossy;          ///< 1: y has a rough lobe, and reflects something else to each pixel

  // By number, of those with glossy y:
  LightDirections to_light, to_sky;  ///< to y's light point, and to its sample of the environment
  LightDirections onward;            ///< of the next segment
  VecArray<batch_size> found;  ///< emission, or image of the environment, where that ends; 0 without MIS
};

/// Points per suffix: 1 over the expected number of suffixes that start at one, on average.
CASTRAY_INLINE float stratum_of(const Context& c, const Origins& origins) {
  return (float)origins.count / (float)c.options.suffixes;
}

/// Stores the lanes of v, of vertices i to i + width - 1, by the numbers of their suffixes.
CASTRAY_INLINE void keep_of_suffixes(VecArray<batch_size>& to, const Vertices& y, int i, const Vec& v) {
  for (int l = 0; l < width && i + l < y.count; ++l) {
    const uint32_t suffix = y.names.slot[i + l] - batch_size;
    to.x[suffix] = lane(v.x, l);
    to.y[suffix] = lane(v.y, l);
    to.z[suffix] = lane(v.z, l);
  }
}

/// The same of numbers.
CASTRAY_INLINE void keep_of_suffixes(float* to, const Vertices& y, int i, Float v) {
  for (int l = 0; l < width && i + l < y.count; ++l) to[y.names.slot[i + l] - batch_size] = lane(v, l);
}

/// Fills in emission, light_density and landed for the vertices y. `emission_varies`: vertices carry
/// their emission; otherwise it is their material's.
void keep_suffix_ends(const Context& c, bool emission_varies, Suffixes& suffixes);

/// Makes light_density that of the cells of emitting triangles, where they have any. `hits`: of the `rays`
/// that found the vertices y.
void scale_by_cells(const Context& c, int rays, const Hits& hits, Suffixes& suffixes);

/// Makes light_density that of each tile's light points, where regions of lights are known. `hits`: of the
/// suffixes' rays.
void scale_light_density(const Context& c, int rays, const Hits& hits, const TileLights* lights,
                         Suffixes& suffixes);

/// Fills in `found`, and the pdf of `onward`, for the next segments `rays` of glossy suffixes, each of which
/// ends in the vertex z of its entry or escapes. `emission_varies` as above.
void keep_found_light(const Context& c, bool emission_varies, const Paths& rays, const Hits& hits,
                      const Vertices& z, Suffixes& suffixes);

/// Copies vertices y with a rough lobe to `glossy`, all others to `others`, where those on mirrors and
/// glass become vertices of private paths. `x`: where suffixes started.
void split_suffixes(const KernelScene& scene, const Vertices& x, Suffixes& suffixes, Vertices& glossy,
                    Vertices& others);

/// Moves the camera's vertices on surfaces that do not gather from `camera` to `out`.
void split_chains(const KernelScene& scene, Vertices& camera, Vertices& out);

}  // namespace castray::CASTRAY_ISA
