#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "castray/film.h"
#include "castray/scene.h"

namespace castray {

enum class Integrator : std::uint8_t { wavefront, reference };
enum class Precision : std::uint8_t { float32, float64 };
enum class SamplerKind : std::uint8_t { sobol, independent };
enum class LightSampling : std::uint8_t { automatic, area, solid_angle, tree };
enum class Switch : std::uint8_t { automatic, on, off };
enum class AccelKind : std::uint8_t { automatic, list, bvh };
enum class BuildQuality : std::uint8_t { automatic, fast, best };

/// The classic faults of a first path tracer, shown on demand by the reference integrator;
/// docs/classic-faults.md.
enum class Fault : std::uint8_t {
  none,
  black_light,      ///< emission added only where it is sampled, not where the camera sees it
  vanishing_boxes,  ///< slab test with t_min < t_max
  white_specks,     ///< uniform hemisphere sampling that meets cos = 0, and clamps NaN to white
  slow_random,      ///< a random engine built at every call
  skewed_light,     ///< triangle chosen by sqrt(u) * area while the density says area
  no_light_choice,  ///< the probability of choosing this light left out of the density
  shared_counter,   ///< a counter shared by threads as the pixel index
};

/// How paths of one tile share suffixes: a tile of width x height pixels, `suffixes` of them traced further.
struct Reuse {
  bool automatic = true;
  int width = 0, height = 0, suffixes = 0;  ///< width 0: off
};

/// All that a render depends on besides the scene. Defaults are those of the command line.
struct RenderOptions {
  int width = 0, height = 0;           ///< full image; 0: the scene's
  std::optional<Window> crop;          ///< only x0..y1 are read
  std::uint64_t spp = 64;              ///< samples per pixel; with a target error, the most
  std::optional<SampleRange> samples;  ///< only these sample indices; else 0 .. spp-1
  std::uint64_t seed = 0;
  int threads = 0;  ///< 0: all that this process may use
  Integrator integrator = Integrator::wavefront;
  Precision precision = Precision::float32;
  std::optional<double> rr;  ///< fixed survival probability in (0,1]; else by throughput
  int max_depth = 0;         ///< path edges; 0: no limit
  std::optional<double>
      epsilon;  ///< the classic absolute epsilon, in the scene file's units; else error bounds
  SamplerKind sampler = SamplerKind::sobol;
  LightSampling lights = LightSampling::automatic;
  Switch mis = Switch::automatic;
  bool jitter = true;
  /// Biased, off by default: the part of each sample that its first bounce brings, light points at the
  /// camera's hit excepted, is scaled down to have no component above this radiance. Hides rare bright
  /// samples, and loses light.
  std::optional<double> clamp_indirect;
  std::string isa = "auto";
  AccelKind accel = AccelKind::automatic;
  BuildQuality build = BuildQuality::automatic;
  bool generic = false;
  Reuse reuse;
  std::optional<double> time_limit;  ///< seconds
  /// relMSE, mean over pixels and channels of (x-r)^2 / (r^2 + 0.01), that the image shall have. A pilot,
  /// whose samples are not in the image, tells how noisy each part of it is and so how many samples it gets.
  std::optional<double> target_error;
  Fault fault = Fault::none;
};

/// A limit of `spp` for renders to a target error that is no limit in practice.
inline constexpr std::uint64_t most_samples_to_target = std::uint64_t{1} << 16;

/// Told to the caller while a render runs, at most some times a second, from one thread at a time.
struct Progress {
  double fraction = 0;      ///< of the work, in [0,1]
  std::uint64_t paths = 0;  ///< finished camera samples
  /// The sums so far, each row at the end of a pass, or null while rows are in work. Saved as a .film it can
  /// be resumed; the result is that of an uninterrupted render, byte for byte.
  const Film* film = nullptr;
};
/// Returns false to stop the render as soon as the rows in work are done.
using ProgressCallback = std::function<bool(const Progress&)>;

enum class Stopped : std::uint8_t { done, time_limit, target_error, interrupted };

/// A sample that was not finite, was dropped, and can be replayed alone.
struct NonfiniteSample {
  int x = 0, y = 0;
  std::uint64_t sample = 0;
};

struct RenderStats {
  int threads = 1;
  std::string isa;                   ///< of the kernel, "none" for the reference
  std::string kernel;                ///< what Plan chose, readable
  std::vector<std::string> skipped;  ///< features the scene does not need
  std::string accel_summary;         ///< e.g. "BVH: 32 triangles, 19 nodes, depth 5, ..."
  double bvh_seconds = 0;
  double render_seconds = 0;               ///< from the first camera ray to the last film sum
  std::uint64_t paths = 0;                 ///< camera samples
  std::uint64_t rays = 0;                  ///< closest-hit and shadow rays traced
  std::vector<NonfiniteSample> nonfinite;  ///< the first few
  std::uint64_t pilot_paths = 0;           ///< of `paths`, those that only told the noise
  std::optional<double> expected_error;    ///< relMSE of the film, with a target error
  Stopped stopped = Stopped::done;
};

struct RenderResult {
  Film film;
  RenderStats stats;
};

/// Renders. A pure function of its arguments: opens no file, prints nothing, never exits. Throws InputError
/// if the options contradict the scene or one another. `start`, if not null, is the film of an earlier run of
/// the same render, stopped early or with fewer samples: only what it lacks is rendered.
RenderResult render(const Scene& scene, const RenderOptions& options, const ProgressCallback& progress = {},
                    const Film* start = nullptr);

/// Renders `replicates` independent replicates (see `replicate_length`) of spp / replicates samples each, or
/// of `options.samples` within each replicate, into a film that keeps them apart and so tells its own noise.
/// If it is stopped early, only whole replicates are kept. Throws InputError also where the samples cannot be
/// divided.
RenderResult render_replicates(const Scene& scene, const RenderOptions& options, std::uint64_t replicates,
                               const ProgressCallback& progress = {});

}  // namespace castray
