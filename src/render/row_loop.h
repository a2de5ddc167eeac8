#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "castray/render.h"
#include "render/sample_map.h"

namespace castray {

/// What rendering some rows hands back besides the film's sums.
struct RowStats {
  std::uint64_t rays = 0;
  std::vector<NonfiniteSample> nonfinite;  ///< samples dropped
};

/// What an integrator does with a band of rows.
struct BandWork {
  int height = 1;  ///< of a band
  /// Bands may add to rows of their neighbours: they see to it that no two threads add to one pixel at a
  /// time, there is one band more than fit the window, and a stop waits for the end of the pass.
  bool overlap = false;
  /// Adds those `samples` that the map wants to the film, for the band that starts at row y0 of the full
  /// image. Called by several threads at a time, for different bands.
  std::function<void(int y0, int y1, const SampleRange& samples, const SampleMap& map, Film& film,
                     RowStats& stats)>
      render;
};

/// The loop around every integrator, which renders the samples that `map` wants: passes over the image, each
/// for some of the samples; in a pass OpenMP hands out bands of rows dynamically, and nothing is shared but
/// the band counter. Tells `progress`, stops at its wish or at the time limit, and fills in all of the stats
/// that it knows.
///
/// As film sums are exact, the passes do not show in the result. They make an early stop leave a whole image
/// and a checkpoint possible: between passes no row is in work. `start`, if not null, is the film of an
/// earlier run of the same render, whose samples are not rendered again.
RenderResult run_rows(const Scene& scene, const RenderOptions& options, const ProgressCallback& progress,
                      const Film* start, const SampleMap& map, const BandWork& work);

/// Adds the counts, the seconds and the first samples that were not finite of an earlier loop.
void add_stats(RenderStats& sum, const RenderStats& earlier);

/// The window that is rendered: the crop, or all of the image.
Window window_of(const Scene& scene, const RenderOptions& options);

/// How many threads render: as asked, or all that this process may use.
int thread_count(const RenderOptions& options);

/// The sample indices that are rendered.
SampleRange samples_of(const RenderOptions& options);

}  // namespace castray
