#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "castray/film.h"
#include "castray/render_options.h"
#include "castray/scene.h"

namespace castray {

/// Reported while a render runs, some times a second, from one thread at a time.
struct Progress {
  double fraction = 0;      ///< of the work, in [0,1]
  std::uint64_t paths = 0;  ///< finished camera samples
  /// The sums so far, each row at the end of a pass, or null while rows are in work, and of replicates. Saved
  /// as a .film they can be resumed; the result equals that of an uninterrupted render, byte for byte. With a
  /// target error they may be those of a pilot, and cannot be resumed.
  const Film* film = nullptr;
};
/// Returns false to stop the render as soon as the rows in work are done. What it throws ends the render and
/// is thrown by the function that renders.
using ProgressCallback = std::function<bool(const Progress&)>;

enum class Stopped : std::uint8_t { done, time_limit, target_error, interrupted };

/// A sample that was not finite, was dropped, and can be replayed alone.
struct NonfiniteSample {
  int x = 0, y = 0;
  std::uint64_t sample = 0;
};

struct RenderStats {
  int threads = 1;
  std::string isa;                         ///< of the kernel, "none" for the reference
  std::string kernel;                      ///< what Plan chose, readable
  std::vector<std::string> skipped;        ///< features the scene does not need
  std::string accel_summary;               ///< e.g. "BVH: 32 triangles, 19 nodes, depth 5, ..."
  double bvh_seconds = 0;                  ///< to build the tree, however often it is rendered
  double pilot_seconds = 0;                ///< of render_seconds: to decide whether paths are shared
  double render_seconds = 0;               ///< from the first camera ray to the last film sum
  std::uint64_t paths = 0;                 ///< camera samples
  std::uint64_t rays = 0;                  ///< closest-hit and shadow rays traced
  std::vector<NonfiniteSample> nonfinite;  ///< the first few
  std::uint64_t pilot_paths = 0;           ///< of `paths`, those of the pilot
  std::optional<double> expected_error;    ///< relMSE of the film, with a target error
  Stopped stopped = Stopped::done;
};

struct RenderResult {
  Film film;
  RenderStats stats;
};

/// A scene made ready to be rendered: its tree or list, lights, and the kernels' data, built once for any
/// number of renders. Never changes; several threads may render it at a time.
class PreparedScene {
 public:
  /// `scene` must outlive this object and not change. Of `options`, the ones that shape what is built count:
  /// size, threads to build with, integrator, precision, epsilon, max-depth, isa, accel, build, generic,
  /// lights, mis, reuse, reconstruct and edge samples. Throws InputError if options contradict the scene or
  /// one another.
  PreparedScene(const Scene& scene, const RenderOptions& options);
  PreparedScene(Scene&&, const RenderOptions&) = delete;
  PreparedScene(PreparedScene&&) noexcept;
  PreparedScene& operator=(PreparedScene&&) noexcept;
  ~PreparedScene();

 private:
  struct Data;
  friend struct PreparedAccess;
  explicit PreparedScene(std::unique_ptr<const Data> data);

  std::unique_ptr<const Data> data_;
};

/// Renders. A pure function of its arguments: opens no file, prints nothing, never exits. Throws InputError
/// if the options contradict one another, the scene, or those that it was prepared with. `start`, if not
/// null, is the film of an earlier run of the same render, stopped early or with fewer samples: only what it
/// lacks is rendered.
RenderResult render(const PreparedScene& scene, const RenderOptions& options,
                    const ProgressCallback& progress = {}, const Film* start = nullptr);

/// Prepares the scene, then renders.
RenderResult render(const Scene& scene, const RenderOptions& options, const ProgressCallback& progress = {},
                    const Film* start = nullptr);

/// Renders `replicates` independent replicates (see `replicate_length`) of spp / replicates samples each, or
/// of `options.samples` within each replicate, into a film that keeps them apart, so that `noise_of` can
/// estimate its noise. If it is stopped early, only whole replicates are kept. Throws InputError also where
/// the samples cannot be divided.
RenderResult render_replicates(const PreparedScene& scene, const RenderOptions& options,
                               std::uint64_t replicates, const ProgressCallback& progress = {});
RenderResult render_replicates(const Scene& scene, const RenderOptions& options, std::uint64_t replicates,
                               const ProgressCallback& progress = {});

}  // namespace castray
