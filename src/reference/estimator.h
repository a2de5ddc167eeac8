#pragma once

#include <cstdint>
#include <optional>

#include "core/contract.h"

namespace castray {

// The estimator, the same in every integrator (cast_ray.h spells it out in code):
//
// * Vertex k = 0, 1, ... of a path is its k-th hit, reached by k + 1 edges. Random numbers are those of
//   PathBlocks, in the order given there.
// * Emission that a ray hits counts in full if the ray is the camera's or was sampled from a perfectly
//   specular lobe. Otherwise light sampling accounts for it: it counts 0, or by its MIS weight
//   (lights/light_share.h).
// * At each vertex one light point is sampled (AreaLights), one direction to an image of the environment
//   (Environment), and what lights without size send is added: of all of them, or of one that is sampled.
// * A constant environment is not sampled as a light: a ray that escapes adds its full radiance.
// * One direction is sampled from the BSDF; then Russian roulette; then the next vertex.

/// The probability that a path goes on from `vertex`. `brightest` is the largest component of its throughput,
/// the next segment's weight included and the radiance scale of refractions taken out.
template <class T>
T survival_probability(const std::optional<double>& fixed, std::uint32_t vertex, T brightest) {
  constexpr T cap = static_cast<T>(highest_survival);
  if (fixed) {
    const T p = static_cast<T>(*fixed);
    return vertex < first_capped_vertex || p < cap ? p : cap;
  }
  if (vertex < first_roulette_vertex) return 1;
  return brightest < cap ? brightest : cap;
}

}  // namespace castray
