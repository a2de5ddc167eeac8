#pragma once

#include <cstdint>

#include "castray/render.h"
#include "castray/scene.h"
#include "core/contract.h"

namespace castray {

// The estimator's contract, kept by every integrator (cast_ray.h spells it out in code):
//
// * Vertex k = 0, 1, ... of a path is its k-th hit, reached by k + 1 edges. Random numbers are those of
//   PathBlocks, in the order given there.
// * Emission found by a ray counts wholly if the ray is the camera's or left a perfectly specular lobe;
//   otherwise light sampling has it, and it counts 0, or its share where multiple importance sampling is on.
// * At each vertex one light point is drawn (AreaLights) and weighed by BSDF, cosines, distance, visibility.
// * The environment is never sampled as a light: a ray that escapes adds all of it.
// * One direction is drawn from the BSDF; then roulette; then the next vertex.

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

/// Share of the technique of density `own` where another of density `other` finds the same path (balance
/// heuristic, Veach and Guibas 1995).
template <class T>
T balance(T own, T other) {
  return own / (own + other);
}

/// Whether the reference combines light and BSDF sampling: as asked, or automatically where emitters cover
/// so much of the scene that light points next to the shaded point would dominate the variance.
bool uses_mis(Switch mis, double emitting_share_of_surface);

}  // namespace castray
