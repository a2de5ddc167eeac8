#pragma once

#include "render/row_loop.h"

namespace castray {

/// Runs the row loop over all the samples that the job asks for: so many of every pixel, or what a target
/// error takes. Arguments as for `run_rows`; no earlier film goes with a target error.
///
/// Adaptive sampling that looks at the samples it keeps is biased: a pixel that happens to look dark and calm
/// would be believed too early. Here a pilot decides, two films of other scrambles than the image's, an
/// eighth of its samples or a little more in all, made in rounds of growing size. Then the image is rendered
/// as planned, without a further look: each block is what it would be in a plain render of as many samples.
RenderResult take_samples(const Job& job, const ProgressCallback& progress, const Film* start,
                          const BandWork& work);

}  // namespace castray
