#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "wavefront/kernel_api.h"

namespace castray {

/// One job's radiance and rays. Called by several threads of one team at once.
using RenderJob = std::function<void(const KernelOptions&, const TileJob&, TileResult&)>;

/// Efficiency, 1 / (error x cost), of shared paths over that of plain ones, by a pilot: both render the same
/// few tiles, some samples in each of some independent replicates. Error is the variance of a pixel's mean
/// over replicates, relative as relMSE is, without what the camera sees of emitters: that is noise of both
/// alike. Cost is counted in rays, of which what pixels gather is a fraction. None if the image is too small
/// to spare a pilot, or if no light was found.
///
/// A function of the scene, the image's full size and `shared` but its seed: never of time, threads, or the
/// part of the image or of its samples that is wanted. So parts of one image agree. None of the pilot's
/// samples is in any image.
std::optional<double> gain_of_sharing(const KernelOptions& shared, int width, int height, int threads,
                                      const RenderJob& render_job);

/// The rays of one job of light paths, whose splats go to the sink. Called likewise.
using LightPathsJob =
    std::function<std::uint64_t(const KernelOptions&, const LightPathJob&, const SplatSink&)>;

/// Efficiency with paths from lights over that without, by a pilot of plain paths and of light paths. The
/// variance of a pixel that chance would have is computed from the light paths: each says how much a path
/// from the camera would bring that finds the same one. So caustics that are too rare for a pilot to find are
/// not missed. A function of the same things as above. None if the image is too small, or if no light path
/// reaches it.
std::optional<double> gain_of_light_paths(const KernelOptions& options, int width, int height, int threads,
                                          const RenderJob& render_job, const LightPathsJob& light_paths_job);

}  // namespace castray
