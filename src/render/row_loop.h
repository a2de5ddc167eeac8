#pragma once

#include "plan/integrator.h"

namespace castray {

/// The loop around every integrator, which renders the samples that `map` wants: passes over the image, each
/// for some of the samples; in a pass OpenMP hands out bands of rows dynamically, and nothing is shared but
/// the band counter. Tells `progress`, stops at its wish or at the time limit, and fills in all of the stats
/// that it knows. What `work` or `progress` throws is thrown on.
///
/// As film sums are exact, the passes do not show in the result. They make an early stop leave a whole image
/// and a checkpoint possible: between passes no row is in work. `start`, if not null, is the film of an
/// earlier run of the same render, whose samples are not rendered again.
RenderResult run_rows(const Job& job, const ProgressCallback& progress, const Film* start,
                      const SampleMap& map, const BandWork& work);

/// Adds the counts, the seconds and the first samples that were not finite of an earlier loop.
void add_stats(RenderStats& sum, const RenderStats& earlier);

}  // namespace castray
