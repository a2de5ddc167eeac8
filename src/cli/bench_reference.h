#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "bench/noise_free.h"
#include "castray/render.h"
#include "cli/render_flags.h"

namespace castray::cli {

/// "A,B" of --reference, where {scene} stands for the scene's name: two independent images of linear
/// radiance. Throws InputError if they cannot be read or have different sizes.
ReferencePair read_references(const std::string& text, const std::string& scene_name);

/// Two references with seeds that no measurement uses, rendered with `options` (their seed is not read) and
/// kept as films in `cache`; what is there already is not rendered again, and a film with fewer samples is
/// carried on. `progress` is told the number of the reference, 0 or 1.
ReferencePair cached_references(const Scene& scene, const RenderRequest& request,
                                const std::filesystem::path& cache,
                                const std::function<void(int, const Progress&)>& progress);

}  // namespace castray::cli
