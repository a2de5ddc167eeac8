#include "castray/render.h"

#include <fmt/format.h>

#include "castray/error.h"
#include "render/prepared_scene.h"
#include "render/row_loop.h"
#include "render/take_samples.h"

namespace castray {

namespace {

/// The name of an option in which `job` differs from the one that a scene was prepared for; or null.
const char* misfit(const Job& job, const Job& prepared) {
  const RenderOptions &a = job.options, &b = prepared.options;
  if (!a.camera && (job.window.full_width != prepared.window.full_width ||
                    job.window.full_height != prepared.window.full_height))
    return "--size";
  if (a.integrator != b.integrator) return "--integrator";
  if (a.precision != b.precision) return "--precision";
  if (a.epsilon != b.epsilon) return "--epsilon";
  if (a.max_depth != b.max_depth) return "--max-depth";
  if (a.lights != b.lights) return "--lights";
  if (a.mis != b.mis) return "--mis";
  if (a.caustics != b.caustics) return "--caustics";
  if (a.isa != b.isa) return "--isa";
  if (a.accel != b.accel) return "--accel";
  if (a.build != b.build) return "--build";
  if (a.generic != b.generic) return "--generic";
  if (a.reuse != b.reuse) return "--reuse";
  if (a.reconstruct != b.reconstruct && (a.reconstruct != Switch::off || b.reconstruct == Switch::on))
    return "--reconstruct";
  if (a.edge_samples != b.edge_samples) return "--edge-samples";
  return nullptr;
}

/// `render`, but for the seconds of the pilot.
RenderResult render_samples(const PreparedScene& scene, const RenderOptions& options,
                            const ProgressCallback& progress, const Film* start) {
  const PreparedAccess::Data& prepared = PreparedAccess::data(scene);
  Job job = make_job(prepared.facts, options, prepared.job.fault);
  if (const char* option = misfit(job, prepared.job))
    throw InputError(fmt::format("{}: the scene was prepared for another one; prepare it anew", option));
  if (options.target_error && start)
    throw InputError("--target-error: cannot go on from an earlier film; leave out the target or the film");
  RenderResult result = take_samples(job, progress, start, *prepared.integrator);
  prepared.integrator->describe(result.film, result.stats);
  return result;
}

/// The pilot ran once, before the first camera ray of the image.
RenderResult with_pilot(RenderResult result) {
  result.stats.render_seconds += result.stats.pilot_seconds;
  return result;
}

SampleRange first_range(const RenderOptions& options, std::uint64_t replicates) {
  if (options.samples) return *options.samples;
  if (options.spp % replicates != 0)
    throw InputError(
        fmt::format("--spp {}: must be a multiple of the {} replicates", options.spp, replicates));
  return {0, options.spp / replicates};
}

}  // namespace

RenderResult render(const PreparedScene& scene, const RenderOptions& options,
                    const ProgressCallback& progress, const Film* start) {
  return with_pilot(render_samples(scene, options, progress, start));
}

RenderResult render(const Scene& scene, const RenderOptions& options, const ProgressCallback& progress,
                    const Film* start) {
  return render(PreparedScene(scene, options), options, progress, start);
}

RenderResult render_replicates(const PreparedScene& scene, const RenderOptions& options,
                               std::uint64_t replicates, const ProgressCallback& progress) {
  const SampleRange range = first_range(options, replicates);
  if (range.first % replicate_length + range.count > replicate_length)
    throw InputError(fmt::format("--replicates: each may hold {} samples at most", replicate_length));
  if (options.reconstruct == Switch::on)
    throw InputError("--reconstruct on: cannot go with --replicates; leave one out");
  if (options.edge_samples) throw InputError("--edge-samples: cannot go with --replicates; leave one out");
  RenderResult whole;
  for (std::uint64_t r = 0; r < replicates; ++r) {
    RenderOptions part_options = options;
    part_options.reconstruct = Switch::off;
    part_options.samples = SampleRange{range.first + r * replicate_length, range.count};
    const auto report = [&](const Progress& p) {
      const double fraction = (static_cast<double>(r) + p.fraction) / static_cast<double>(replicates);
      return !progress || progress({fraction, whole.stats.paths + p.paths, nullptr});
    };
    RenderResult part = render_samples(scene, part_options, report, nullptr);
    part.film.keep_replicates();
    add_stats(part.stats, whole.stats);
    whole.stats = part.stats;
    if (r == 0)
      whole.film = std::move(part.film);
    else if (part.stats.stopped == Stopped::done)
      whole.film.merge(part.film);
    if (part.stats.stopped != Stopped::done) break;
  }
  return with_pilot(std::move(whole));
}

RenderResult render_replicates(const Scene& scene, const RenderOptions& options, std::uint64_t replicates,
                               const ProgressCallback& progress) {
  return render_replicates(PreparedScene(scene, options), options, replicates, progress);
}

}  // namespace castray
