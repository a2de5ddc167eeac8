#pragma once

#include <algorithm>
#include <cstddef>

#include "wavefront/pilot_tiles.h"

namespace castray {

/// Batches of light paths that make one path for each pixel, within bounds; even.
inline std::size_t batches_of(const Pilot& pilot) {
  constexpr std::size_t fewest = 8, most = 64;
  const std::size_t pixels = static_cast<std::size_t>(pilot.width) * static_cast<std::size_t>(pilot.height);
  return 2 * std::clamp(pixels / (2 * batch_size), fewest, most);
}

/// Calls trace(i, job) for `batches` batches of light paths, by the pilot's threads.
template <class Trace>
void for_each_batch(const Pilot& pilot, std::size_t batches, Trace trace) {
#pragma omp parallel for schedule(dynamic) num_threads(pilot.threads)
  for (std::size_t i = 0; i < batches; ++i)
    trace(i, LightPathJob{0, i * batch_size, batch_size, pilot.width, pilot.height});
}

}  // namespace castray
