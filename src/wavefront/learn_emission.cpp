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

}  // namespace

std::vector<UsefulEmission> useful_emission(const Pilot& pilot, KernelOptions options,
                                            const LightPathsJob& light_paths_job) {
  options.seed = hash_combine(0x9170fu, 1u);
  std::vector<std::vector<UsefulEmission>> batches(batches_of(pilot));
  for_each_batch(pilot, batches.size(), [&](std::size_t i, LightPathJob job) {
    const EmissionSink sink{&batches[i], [](void* self, const FocusedEmission& found) {
                              add(*static_cast<std::vector<UsefulEmission>*>(self), found);
                            }};
    job.emission = &sink;
    light_paths_job(options, job, {});
  });
  std::vector<UsefulEmission> samples;  // in the batches' order, whatever the threads
  for (const auto& batch : batches) samples.insert(samples.end(), batch.begin(), batch.end());
  return samples;
}

double light_paths_enough(std::size_t unguided, std::size_t guided) {
  constexpr double fewest = 1.0 / 16;  // what paths are worth differs too much to do with a few good ones
  constexpr double worthwhile = 0.5;   // as it differs more with a guide
  if (unguided == 0) return 1;
  const double enough = static_cast<double>(unguided) / static_cast<double>(guided);
  return enough > worthwhile ? 1 : std::max(enough, fewest);
}

}  // namespace castray
