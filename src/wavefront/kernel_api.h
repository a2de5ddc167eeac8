#pragma once

#include <stdint.h>

#include "cameras/camera_records.h"
#include "core/contract.h"
#include "geometry/geometry_records.h"
#include "geometry/ray_batches.h"
#include "lights/light_records.h"
#include "materials/kernel_material.h"

// What the program and the kernels exchange: plain data and a table of functions, the same for every
// instruction set. Everything is in scene space.

namespace castray {

/// Camera hits, where all samples of a pixel have the same camera ray: a table over pixels, from (x0,y0)
/// on.
struct FirstHits {
  float *t, *b1, *b2;  ///< null: camera rays differ between samples
  uint32_t* primitive;
  int x0, y0, width, height;
  bool known;  ///< false: fill the table, render nothing
};

/// Pixels that see an edge: a table over all pixels that tiles reach, from (x0,y0) on.
struct EdgeTable {
  const uint8_t* kinds = nullptr;  ///< 0: none; else bit 0 is set. Null: no pixel is known to see one
  int x0 = 0, y0 = 0, width = 0;
};

struct KernelScene : MaterialTables {
  SceneGeometry geometry;
  LightList lights;
  KernelCamera camera;
  FirstHits first_hits;
  EdgeTable edges;
};

struct KernelOptions {
  bool sobol;
  bool jitter;
  bool fixed_roulette;
  float survival;           ///< survival probability of fixed roulette
  uint32_t first_roulette;  ///< vertex of plain paths at which roulette by throughput starts
  uint32_t max_depth;       ///< in path edges; 0: no limit
  float most_indirect;      ///< bound of each component of a sample's indirect part; may be infinite
  bool mis;                 ///< weigh emission found by BSDF sampling against light sampling
  bool light_paths;         ///< bring the caustics that the camera sees directly: see light_paths_lanes.h
  int suffixes;             ///< traced for each tile; 0: pixels share no paths
  int branches;             ///< of plain paths, from what a camera ray meets; 0 counts as 1
  int light_points;         ///< shared by the pixels of a tile
  int environment_points;   ///< samples of the environment, likewise; a power of two, or 0
  uint64_t ragged;          ///< samples with a lower index have tiles with ragged edges
  uint32_t seed;            ///< hashed; what pixel keys start from
};

inline constexpr int tile_size = 8;
inline constexpr int tile_pixels = tile_size * tile_size;
inline constexpr int max_tiles = 8;  ///< of a job
inline constexpr int batch_size = tile_pixels * max_tiles;

/// Top left pixel of a tile, in the full image, and its place in the grid of tiles.
struct TilePlace {
  int x, y, grid_x, grid_y;
  uint32_t repeat = 0, repeats = 1;  ///< which of how many takes of the tile's sample: see sample_of
};

/// The unit of work: one sample of `tiles` tiles of 8x8 pixels, side by side.
struct TileJob {
  int x, y;            ///< top left pixel in the full image; may lie outside
  int grid_x, grid_y;  ///< of the first tile, in the grid of tiles
  int tiles;
  uint64_t sample;
  /// Pixels that see an edge have the camera ray of this sample, plus the tile's repeat, under `edge_seed`.
  uint64_t edge_sample = 0;
  uint32_t edge_seed = 0;
  /// By tile, where it is, if tiles are not side by side. Null: side by side, none of them repeated.
  const TilePlace* places = nullptr;
};

/// How far outside its tile a pixel of a ragged tile lies at most.
inline constexpr int ragged_reach = tile_size / 2;

/// Result of a job: positions in the full image, and radiance, of pixel i of tile k at 64 k + i. `rays` grows
/// by the visibilities found, traced or gathered, `gathered` by those that pixels gathered from what a tile
/// shares, `asked` by those of them that took a ray each, `evaluated` by the BSDFs other than Lambert's that
/// gathering took.
struct TileResult {
  uint32_t *x, *y;  ///< as signed numbers, for pixels left of or above the image
  float* radiance[3];
  uint64_t rays, gathered, asked, evaluated;
  float* emitted[3] = {};          ///< if not null: the part of `radiance` that the camera sees directly
  uint64_t edges[max_tiles] = {};  ///< by tile, a bit for each pixel: it sees an edge
};

/// What lights emit towards surfaces that focus; or what arrives of it on others.
struct FocusedEmission {
  int count;
  const float* p[3];  ///< points of lights; or where it arrives
  const float* w[3];  ///< unit vectors along which it leaves them; or to where it comes from
  const float* flux;  ///< greatest component, over the number of pixels
};
struct EmissionSink {
  void* self;
  void (*add)(void* self, const FocusedEmission&);
};

/// Some of the paths from lights of one sample, at most batch_size, that have numbers from `first` on, a
/// multiple of batch_size.
struct LightPathJob {
  uint64_t sample, first;
  int count;
  int width, height;                       ///< of the full image
  const EmissionSink* emission = nullptr;  ///< if not null: gets what is focused, and paths end there, or
  const EmissionSink* arrivals = nullptr;  ///< go on to where it arrives, which this gets
};

/// Splats: radiance that light paths add to the pixels (x,y), over the number of light paths per pixel.
struct Splats {
  int count;
  const uint32_t *x, *y;
  const float* radiance[3];
  const float* by_chance[3];  ///< what a path from the camera would bring that found the same path by chance
};
struct SplatSink {
  void* self;
  void (*add)(void* self, const Splats&);
};

/// Returns the number of rays traced.
using TraceLightPaths = uint64_t (*)(const KernelScene&, const KernelOptions&, const LightPathJob&,
                                     void* scratch, const SplatSink&);

using RenderTiles = void (*)(const KernelScene&, const KernelOptions&, const TileJob&, void* scratch,
                             TileResult&);

/// The functions of one instruction set.
struct KernelApi {
  const char* name;  ///< "scalar", "sse4", "avx2", "avx512"
  int width;         ///< lanes
  uint64_t scratch_bytes;
  /// By KernelFeature set; null where none is compiled. `scratch`: scratch_bytes, aligned to 64, of the
  /// calling thread.
  RenderTiles render_tiles[kernel_feature_sets];
  TraceLightPaths trace_light_paths[kernel_feature_sets];  ///< likewise; null without other materials than
                                                           ///< diffuse ones, and with instances
  /// sample_block of core/sequences.h, for samples of the first epoch.
  void (*sample_block)(bool sobol, uint32_t key, uint32_t index, uint32_t block, float* u);
  void (*bvh_closest)(const WideBvhView&, const RayBatch&);      ///< the nearest hit of every ray
  void (*bvh_occluded)(const WideBvhView&, const ShadowBatch&);  ///< whether each ray hits anything
  /// The same over instances.
  void (*instances_closest)(const InstanceTree&, const RayBatch&);
  void (*instances_occluded)(const InstanceTree&, const ShadowBatch&);
  /// The same over a list, with list_slack or segment_slack: t and facet of the nearest; whether one is at 0
  /// < t < 1.
  void (*facets_closest)(const FacetList&, float slack, const RayBatch&);
  void (*facets_occluded)(const FacetList&, float slack, const ShadowBatch&);
  /// The lane models of a scene's materials, images left out.
  void (*evaluate_bsdfs)(const MaterialTables&, const BsdfBatch&);
  /// The choice among a scene's lights.
  void (*choose_lights)(const LightList&, const LightChoiceBatch&);
};

namespace scalar {
const KernelApi& kernel_api();
}
namespace sse4 {
const KernelApi& kernel_api();
}
namespace avx2 {
const KernelApi& kernel_api();
}
namespace avx512 {
const KernelApi& kernel_api();
}

}  // namespace castray
