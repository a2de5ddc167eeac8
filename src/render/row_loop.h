#pragma once

#include "plan/integrator.h"

namespace castray {

/// The loop around every integrator: renders the samples of `map` in passes over the image, each for some of
/// the samples. In a pass OpenMP hands out bands of rows dynamically. Calls `progress`, stops when it returns
/// false or at the time limit (see RenderOptions::whole_passes), and fills in the statistics that it knows.
/// Exceptions of `work` and `progress` are passed on to the caller.
///
/// Film sums are exact, so that the result does not depend on the passes. Between passes no row is in work:
/// then an early stop leaves an image without gaps, and a checkpoint can be saved. `start`, if not null, is
/// the film of an earlier run of the same render, whose samples are not rendered again.
RenderResult run_rows(const Job& job, const ProgressCallback& progress, const Film* start,
                      const SampleMap& map, const BandWork& work);

/// Adds the counts, the seconds and the first samples that were not finite of an earlier loop.
void add_stats(RenderStats& sum, const RenderStats& earlier);

}  // namespace castray
