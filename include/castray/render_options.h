#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "castray/film.h"
#include "castray/scene.h"

namespace castray {

/// `automatic`: the wavefront, except with an absolute epsilon, which only the reference has.
enum class Integrator : std::uint8_t { automatic, wavefront, reference };
enum class Precision : std::uint8_t { float32, float64 };
enum class SamplerKind : std::uint8_t { sobol, independent };
enum class LightSampling : std::uint8_t { automatic, area, solid_angle, tree };
enum class Switch : std::uint8_t { automatic, on, off };
enum class AccelKind : std::uint8_t { automatic, list, bvh };
enum class BuildQuality : std::uint8_t { automatic, fast, best };

/// How paths of one tile share suffixes: a tile of width x height pixels, `suffixes` of them traced further.
struct Reuse {
  bool automatic = true;
  int width = 0, height = 0, suffixes = 0;  ///< width 0: off
  friend bool operator==(const Reuse&, const Reuse&) = default;
};

/// All that a render depends on besides the scene. Defaults are those of the command line.
struct RenderOptions {
  int width = 0, height = 0;   ///< full image; 0: the scene's
  std::optional<Window> crop;  ///< only x0..y1 are read
  /// A view of the prepared scene in place of its own, in scene space; the size may then be another one than
  /// it was prepared for. What pilots decided stays. Not with the reference integrator.
  std::optional<Camera> camera;
  std::uint64_t spp = 64;              ///< samples per pixel; with a target error, the most
  std::optional<SampleRange> samples;  ///< only these sample indices; else 0 .. spp-1
  /// With `samples`: those of the whole render, of which they are a part; noted in the film.
  std::optional<SampleRange> planned;
  std::uint64_t seed = 0;
  int threads = 0;  ///< 0: all that this process may use
  Integrator integrator = Integrator::automatic;
  Precision precision = Precision::float32;  ///< of the reference
  std::optional<double> rr;                  ///< fixed survival probability in (0,1]; else by throughput
  int max_depth = 0;                         ///< path edges; 0: no limit
  /// The classic absolute ray-origin offset, in the scene file's units, of the reference; else offsets come
  /// from error bounds.
  std::optional<double> epsilon;
  SamplerKind sampler = SamplerKind::sobol;
  LightSampling lights = LightSampling::automatic;
  Switch mis = Switch::automatic;
  bool jitter = true;
  /// Biased, off by default: the part of each sample that its first bounce brings, light points at the
  /// camera's hit excepted, is scaled down to have no component above this radiance. Hides rare bright
  /// samples, and loses light.
  std::optional<double> clamp_indirect;
  /// Whether paths from lights bring the caustics that the camera sees directly, where there are perfectly
  /// specular materials and lights with an area. `automatic`: as a pilot decides.
  Switch caustics = Switch::automatic;
  std::string isa = "auto";
  AccelKind accel = AccelKind::automatic;
  BuildQuality build = BuildQuality::automatic;
  bool generic = false;
  Reuse reuse;
  /// Whether the film keeps differences, from which its image is reconstructed (`image_of`). `automatic`:
  /// where paths are shared and a pilot finds that it pays; with a target error, where means would need many
  /// samples; not with replicates. `on`: shares paths.
  Switch reconstruct = Switch::automatic;
  /// How many samples the tiles that see an edge of a surface get for each sample of the others, where the
  /// film keeps differences: from 1 to most_edge_samples. Their mean is one sample of the film. Else as many
  /// as usually pay.
  std::optional<int> edge_samples;
  std::optional<double> time_limit;  ///< seconds; every pixel gets a sample, however long that takes
  /// An early stop comes at the end of a pass over the image, so that the film can be resumed. Else it comes
  /// at once, and some rows have a sample or some more than others. A pass takes about a second, or one
  /// sample per pixel if that takes longer.
  bool whole_passes = true;
  /// relMSE, mean over pixels and channels of (x-r)^2 / (r^2 + 0.01), that the image shall have. A pilot,
  /// whose samples are not in the image, measures the noise of each part of it and so how many samples it
  /// gets.
  std::optional<double> target_error;
};

inline constexpr int most_edge_samples = 8;

/// A limit of `spp` for renders to a target error that is no limit in practice.
inline constexpr std::uint64_t most_samples_to_target = std::uint64_t{1} << 16;

}  // namespace castray
