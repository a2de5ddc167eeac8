#include "wavefront/learn_emission.h"

#include <algorithm>

#include "core/sequences.h"

namespace castray {

namespace {

std::size_t batches_of(const Pilot& pilot) {
  constexpr std::size_t fewest = 16, most = 128;
  const std::size_t pixels = static_cast<std::size_t>(pilot.width) * static_cast<std::size_t>(pilot.height);
  return std::clamp(pixels / batch_size, fewest, most);
}

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
#pragma omp parallel for schedule(dynamic) num_threads(pilot.threads)
  for (std::size_t i = 0; i < batches.size(); ++i) {
    const EmissionSink sink{&batches[i], [](void* self, const FocusedEmission& found) {
                              add(*static_cast<std::vector<UsefulEmission>*>(self), found);
                            }};
    const LightPathJob job{0, i * batch_size, batch_size, pilot.width, pilot.height, &sink};
    light_paths_job(options, job, {});
  }
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
