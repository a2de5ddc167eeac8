#pragma once

#include "plan/integrator.h"

namespace castray {

/// Runs the row loop over all the samples that the job asks for: so many of every pixel, or what a target
/// error takes. `job`: its key without the integrator's decisions. Other arguments as for `run_rows`; no
/// earlier film goes with a target error.
///
/// Adaptive sampling that decides by the samples it keeps is biased: a pixel that looks dark and noise-free
/// by chance is stopped too early. Here a pilot decides: two films with other scrambles than the image's,
/// made in rounds of growing size, with about an eighth of the image's samples in all. Then the image is
/// rendered as planned, so that each block equals that of a plain render with as many samples. Pilots begin
/// with films of means; where these need many samples, and the integrator can, films that keep differences
/// take over, and the error is that of reconstructed images.
RenderResult take_samples(const Job& job, const ProgressCallback& progress, const Film* start,
                          const PreparedIntegrator& integrator);

}  // namespace castray
