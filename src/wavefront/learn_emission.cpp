#include "wavefront/learn_emission.h"

#include <algorithm>

#include "core/sequences.h"
#include "wavefront/pilot_light_paths.h"

namespace castray {

namespace {

void add(std::vector<UsefulEmission>& samples, const FocusedEmission& found) {
  for (int i = 0; i < found.count; ++i) {
    const auto at = [i](const float* const(&v)[3]) { return Vec3f(v[0][i], v[1][i], v[2][i]); };
    samples.push_back({at(found.p), at(found.w), found.flux[i]});
  }
}

EmissionSink sink_of(std::vector<UsefulEmission>& samples) {
  return {&samples, [](void* self, const FocusedEmission& found) {
            add(*static_cast<std::vector<UsefulEmission>*>(self), found);
          }};
}

void append(std::vector<UsefulEmission>& to, const std::vector<UsefulEmission>& samples) {
  to.insert(to.end(), samples.begin(), samples.end());
}

}  // namespace

FocusedLight focused_light(const Pilot& pilot, KernelOptions options, bool arrivals,
                           const LightPathsJob& light_paths_job) {
  options.seed = hash_combine(0x9170fu, 1u);
  std::vector<FocusedLight> batches(batches_of(pilot));
  for_each_batch(pilot, batches.size(), [&](std::size_t i, LightPathJob job) {
    const EmissionSink emission = sink_of(batches[i].emission), arriving = sink_of(batches[i].arrivals);
    job.emission = &emission;
    if (arrivals) job.arrivals = &arriving;
    light_paths_job(options, job, {});
  });
  FocusedLight all;  // in the batches' order, whatever the threads
  for (const FocusedLight& batch : batches) {
    append(all.emission, batch.emission);
    append(all.arrivals, batch.arrivals);
  }
  return all;
}

double light_paths_enough(std::size_t unguided, std::size_t guided) {
  constexpr double fewest = 1.0 / 16;  // what paths are worth differs too much to do with a few good ones
  constexpr double worthwhile = 0.5;   // as it differs more with a guide
  if (unguided == 0) return 1;
  const double enough = static_cast<double>(unguided) / static_cast<double>(guided);
  return enough > worthwhile ? 1 : std::max(enough, fewest);
}

}  // namespace castray
