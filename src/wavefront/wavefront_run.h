#pragma once

#include <cstdint>
#include <mutex>
#include <vector>

#include "plan/integrator.h"
#include "plan/plan.h"
#include "wavefront/edge_emission.h"
#include "wavefront/kernel_scene.h"
#include "wavefront/pixel_edges.h"
#include "wavefront/workplace.h"

namespace castray {

/// What is rendered of a sample at once: all of it, or one of two takes with half of the suffixes each, in
/// grids half a tile apart. The first sample has two where the film keeps differences: of one grid alone,
/// there are none between its tiles.
struct Take {
  std::uint64_t sample = 0;
  int number = 0, of = 1;

  bool is_last() const { return number + 1 == of; }
};

/// One render of a scene, tile row by tile row. The scene and its data must outlive it.
class WavefrontRun {
 public:
  WavefrontRun(const Scene& scene, const KernelApi& kernel, const KernelSceneData& data, const Plan& plan,
               const Job& job);

  /// Tile row `row` of each sample's grid, and the last one or two where the grid has more than there are
  /// bands. A few columns after the other, each with all samples, so that their sums stay in the cache.
  void render_band(int row, const SampleRange& samples, const SampleMap& map, Film& film, RowStats& stats);

 private:
  /// How many takes a sample has.
  int takes_of(std::uint64_t sample) const;

  /// A few columns of a band.
  void render_take(const Take& take, int row, int column, const SampleMap& map, Film& film, RowStats& stats);

  /// Renders a job, its tiles that see an edge several times.
  void render_job(const TileJob& job, const KernelOptions& options, Workplace& workplace,
                  TileResult& result) const;

  /// All that the tiles of any sample's grid reach.
  void find_first_hits();

  int lock_of(int y) const { return (y - window_.y0) / tile_size; }

  /// Whether the sample of pixel (x,y) counts: it lies in the window, is wanted, and is finite, or is told if
  /// `stats` is not null.
  bool keeps(int x, int y, std::uint64_t sample, const Vec3f& radiance, const SampleMap& map,
             RowStats* stats) const;

  /// Adds a job's samples to the film where they lie in its window and are wanted, under the locks of the
  /// rows they share with other jobs.
  void add(const TileJob& job, int reach, const TileResult& result, const SampleMap& map, Film& film,
           RowStats& stats);

  /// A band's part of a sample's light paths.
  void trace_light_paths(int row, std::uint64_t sample, Film& film, RowStats& stats);

  void add_splat(int x, int y, std::uint64_t sample, const Vec3f& radiance, Film& film, RowStats& stats);

  /// As `add`, for a film that keeps differences: whole tiles.
  void add_tiles(const TileJob& job, const Take& take, int reach, const TileResult& result,
                 const SampleMap& map, Film& film, RowStats& stats);

  /// Whether all pixels that tile k of a job may have lie in the window and want its sample.
  bool wants_all(const TileJob& job, int k, bool ragged, const SampleMap& map) const;

  /// What a take that is no sample's last has of values that are not finite is not told.
  TileSamples tile_samples(const TileJob& job, const Take& take, int k, bool ragged, const TileResult& result,
                           const SampleMap& map, RowStats& stats) const;

  /// Puts a better estimate of what the camera sees of lamps in the place of pixel i's.
  void settle_emission(int x, int y, std::uint64_t sample, int i, const TileResult& result) const;

  Window window_;
  KernelScene scene_;
  bool differences_;  ///< kept by the film
  PixelEdges edges_;  ///< if so
  int edge_samples_;  ///< as in Plan; 1 if not
  EdgeEmission edge_emission_;
  KernelOptions options_;
  RenderTiles render_tiles_;
  TraceLightPaths trace_light_paths_;  ///< or null
  double light_paths_per_pixel_;       ///< of the full image, for each sample
  int bands_;
  std::vector<std::mutex> row_locks_;
  std::vector<Workplace> workplaces_;
  std::vector<float> first_hits_;
  std::vector<std::uint32_t> first_primitives_;
};

}  // namespace castray
