#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "wavefront/kernel_api.h"
#include "wavefront/pilot_tiles.h"

namespace castray {

/// The rays of one job of light paths, whose splats go to the sink. Called as RenderJob is.
using LightPathsJob =
    std::function<std::uint64_t(const KernelOptions&, const LightPathJob&, const SplatSink&)>;

/// Efficiencies, 1 / (error x cost), of techniques over each other, as a pilot finds them. None where it does
/// not ask, or cannot know: if the image is too small to spare a pilot, or no light is found.
struct Gains {
  std::optional<double> light_paths;  ///< of paths from lights over chance
  std::optional<double>
      sharing_by_lights;  ///< of shared over plain paths, with caustics by paths from lights
  std::optional<double> sharing_by_chance;            ///< the same with caustics by chance
  bool few_by_lights = false, few_by_chance = false;  ///< whether these are with half of the suffixes
  double sharing_error = 1;        ///< the standard error of the gain of sharing, as a factor
  bool by_single_samples = false;  ///< all of this: the image was too small to try four of each tile
  /// Of twice as many paths from lights over as many as were tried.
  std::optional<double> twice_with_plain, twice_with_shared;
  /// Of images from differences of pixels over those from means, at few samples and with shared paths.
  std::optional<double> reconstruction_by_lights, reconstruction_by_chance;
};

/// Which choices are open. Others are as in the options.
struct OpenChoices {
  bool caustics = false, sharing = false, reconstruction = false;
  bool few = false;  ///< where paths are shared, half of the suffixes may do
};

/// Tries shared and plain paths, with caustics by light paths and by chance, as far as that is open.
///
/// Few samples tell how an error falls with their number, so shared paths are judged by what theirs is
/// expected to be at 64. The variance that chance brings is computed from light paths, each of which says how
/// much a path from the camera would bring that finds the same one: so caustics that are too rare for a pilot
/// to find are not missed. Where its tiles find them often, these tell how much of it sharing leaves.
///
/// Tiles are tried without chance where light paths would win whatever sharing leaves of it. Their gain is
/// then that over chance of which it leaves all.
///
/// Tiles are tried in groups, first by single samples, then by four, until what a wrong choice is expected to
/// lose is less than the time that another group would take. All together they take at most a few per cent of
/// the time of an image of 16 samples by plain paths, unless shared ones are much better for sure.
///
/// A function of the scene, the image's full size and the options but their seed: never of time, threads, or
/// the part of the image or of its samples that is wanted. So parts of one image agree. None of the pilot's
/// samples is in any image.
Gains find_gains(const Pilot& pilot, const KernelOptions& options, const OpenChoices& open,
                 const LightPathsJob& light_paths_job);

}  // namespace castray
