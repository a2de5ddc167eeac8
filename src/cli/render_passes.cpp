#include "cli/render_passes.h"

#include <algorithm>

#include "castray/error.h"
#include "cli/interrupt.h"
#include "cli/phase.h"
#include "cli/values.h"

namespace castray::cli {

namespace {

constexpr int edges_of_direct_light = 2;

bool needs_light(const PassSet& passes) { return passes.has(Pass::direct) || passes.has(Pass::indirect); }

bool has_only_direct_light(const RenderOptions& options) {
  return options.max_depth > 0 && options.max_depth <= edges_of_direct_light;
}

}  // namespace

PassSet parse_passes(const std::string& flag, const std::string& text) {
  PassSet set;
  for (const std::string& name : split(text, ',')) {
    if (name != "all") {
      set.add(parse_choice<Pass>(flag, name, pass_names));
      continue;
    }
    for (const auto& [each, pass] : pass_names)
      if (pass != Pass::variance) set.add(pass);
  }
  return set;
}

void check_passes(const RenderRequest& request) {
  if (request.passes.empty()) return;
  const auto is_exr = [](const auto& output) { return has_layers(output); };
  if (std::ranges::none_of(request.outputs, is_exr))
    throw InputError("--passes: only .exr files hold passes; add -o FILE.exr");
  if (request.passes.has(Pass::variance) && !request.replicates)
    throw InputError("--passes variance: is the spread of independent replicates; add --replicates 16");
  const RenderOptions& options = request.options;
  if (needs_light(request.passes) && (options.time_limit || options.target_error))
    throw InputError(
        "--passes: direct and indirect need as many samples of direct light as of all, and cannot go with "
        "--time-limit or --target-error; leave them out");
}

Passes surface_passes(const Scene& scene, const RenderRequest& request, ProgressMode mode) {
  const Phase phase(mode, "rendering passes of what the camera sees");
  std::optional<Passes> passes =
      render_passes(scene, request.options, request.passes, [] { return !interrupted(); });
  if (!passes) throw PassesInterrupted();
  return std::move(*passes);
}

void add_film_passes(Passes& passes, const Scene& scene, const RenderRequest& request, const Film& film,
                     ProgressMode mode) {
  if (request.passes.has(Pass::samples)) add_samples(passes, film);
  if (!needs_light(request.passes)) return;
  const int threads = request.options.threads;
  const Image all = image_of(film, threads);
  if (has_only_direct_light(request.options)) return add_light(passes, request.passes, all, all);
  const Phase phase(mode, "rendering direct light alone");
  RenderRequest direct = request;
  direct.options.max_depth = edges_of_direct_light;
  const RenderResult result =
      render(prepare(scene, direct), direct.options, [](const Progress&) { return !interrupted(); });
  if (result.stats.stopped == Stopped::done)
    add_light(passes, request.passes, all, image_of(result.film, threads));
}

}  // namespace castray::cli
