#include <fmt/format.h>

#include "castray/error.h"
#include "castray/render.h"
#include "render/row_loop.h"

namespace castray {

namespace {

SampleRange first_range(const RenderOptions& options, std::uint64_t replicates) {
  if (options.samples) return *options.samples;
  if (options.spp % replicates != 0)
    throw InputError(
        fmt::format("--spp {}: must be a multiple of the {} replicates", options.spp, replicates));
  return {0, options.spp / replicates};
}

}  // namespace

RenderResult render_replicates(const Scene& scene, const RenderOptions& options, std::uint64_t replicates,
                               const ProgressCallback& progress) {
  const SampleRange range = first_range(options, replicates);
  if (range.first % replicate_length + range.count > replicate_length)
    throw InputError(fmt::format("--replicates: each may hold {} samples at most", replicate_length));
  RenderResult whole;
  for (std::uint64_t r = 0; r < replicates; ++r) {
    RenderOptions part_options = options;
    part_options.samples = SampleRange{range.first + r * replicate_length, range.count};
    RenderResult part = render(scene, part_options, [&](const Progress& p) {
      const double fraction = (static_cast<double>(r) + p.fraction) / static_cast<double>(replicates);
      return !progress || progress({fraction, whole.stats.paths + p.paths, nullptr});
    });
    part.film.keep_replicates();
    add_stats(part.stats, whole.stats);
    whole.stats = part.stats;
    if (r == 0)
      whole.film = std::move(part.film);
    else if (part.stats.stopped == Stopped::done)
      whole.film.merge(part.film);
    if (part.stats.stopped != Stopped::done) break;
  }
  return whole;
}

}  // namespace castray
