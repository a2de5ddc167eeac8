#pragma once

#include <cstdint>

namespace castray {

/// The classic faults of a first path tracer, shown on demand by the reference integrator;
/// docs/classic-faults.md.
enum class Fault : std::uint8_t {
  none,
  black_light,      ///< emission added only where it is sampled, not where the camera sees it
  vanishing_boxes,  ///< slab test with t_min < t_max
  white_specks,     ///< uniform hemisphere sampling that meets cos = 0, and clamps NaN to white
  slow_random,      ///< a random engine built at every call
  skewed_light,     ///< triangle chosen by sqrt(u) * area while the density says area
  no_light_choice,  ///< the probability of choosing this light left out of the density
  shared_counter,   ///< a counter shared by threads as the pixel index
};

}  // namespace castray
