#pragma once

#include "castray/passes.h"
#include "cli/render_flags.h"

namespace castray::cli {

/// An interrupt before the first sample.
struct PassesInterrupted {};

/// The passes of a comma list, or "all". Throws InputError.
PassSet parse_passes(const std::string& flag, const std::string& text);

/// Throws InputError where what is requested cannot go with the passes.
void check_passes(const RenderRequest& request);

/// The passes of what the camera's rays meet; says so if it takes long. Throws PassesInterrupted.
Passes surface_passes(const Scene& scene, const RenderRequest& request, ProgressMode mode);

/// Adds the passes of a finished film. Direct light takes a second render, with paths of two edges.
void add_film_passes(Passes& passes, const Scene& scene, const RenderRequest& request, const Film& film,
                     ProgressMode mode);

}  // namespace castray::cli
