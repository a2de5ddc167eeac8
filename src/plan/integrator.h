#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "castray/render.h"
#include "plan/job.h"
#include "plan/sample_map.h"

namespace castray {

/// What rendering some rows hands back besides the film's sums.
struct RowStats {
  std::uint64_t rays = 0;
  std::uint64_t light_paths = 0;           ///< see Film::light_paths
  std::vector<NonfiniteSample> nonfinite;  ///< samples dropped
};

/// What an integrator does with a band of rows.
struct BandWork {
  int height = 1;  ///< of a band
  /// Bands may add to rows of their neighbours. Then `render` locks the rows, there is one band more than
  /// fits the window, and a stop within a pass leaves a film that cannot be resumed.
  bool overlap = false;
  bool splats = false;  ///< the film must keep them; bands may add them anywhere, under locks of their own
  bool differences = false;  ///< the film must keep them
  bool shared = false;  ///< pixels share paths: the error of a pixel's first samples tells little of more
  /// Adds those `samples` that the map wants to the film, for the band that starts at row y0 of the full
  /// image. Called by several threads at a time, for different bands.
  std::function<void(int y0, int y1, const SampleRange& samples, const SampleMap& map, Film& film,
                     RowStats& stats)>
      render;
};

/// A scene made ready for one integrator. Const, and used by several renders at a time.
class PreparedIntegrator {
 public:
  virtual ~PreparedIntegrator() = default;
  /// The work of one render. `job`, whose shaping options are those of the preparation, and this object must
  /// outlive it.
  virtual BandWork work(const Job& job) const = 0;
  /// What was decided for the scene and the job and changes samples, as items of the film key, each after ";
  /// ".
  virtual std::string decisions(const Job&) const { return {}; }
  /// Fills in instruction set, kernel, what is not needed, the tree, and the seconds of the pilot, for a film
  /// that was rendered.
  virtual void describe(const Film& film, RenderStats& stats) const = 0;
};

}  // namespace castray
