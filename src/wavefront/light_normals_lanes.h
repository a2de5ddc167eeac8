#pragma once

#include "wavefront/shading_lanes.h"

// Shading normals at the vertices of paths from lights. A vertex that is seen from direction w has its smooth
// or bent normal n if w is on n's side of the surface, and the geometric one if not. A path from a light
// learns only by scattering from where its vertex is seen, and keeps n until then: it scatters by one of both
// normals, which counts if it is the one that is seen.

namespace castray::CASTRAY_ISA {

/// Whether n is the shading normal of a surface that is seen from w. `normal`: the geometric one.
CASTRAY_INLINE Mask shows_shading_normal(Vec n, Vec normal, Vec w) {
  return dot(n, w) * dot(normal, w) > Float(0.f);
}

/// The shading normal of a surface that is seen from w.
CASTRAY_INLINE Vec normal_seen_from(Vec n, Vec normal, Vec w) {
  return select(shows_shading_normal(n, normal, w), n, normal);
}

/// The normal by which a path from a light scatters.
struct ScatteringNormal {
  Vec n;
  Mask geometric;
  Float weight;  ///< 1 over the probability of its choice
};

/// By u in [0,1), one of n and `normal`: the geometric one the more often the farther both are apart, as
/// directions that see it are between the planes of both. Light from behind n, from wo, leaves no choice.
CASTRAY_INLINE ScatteringNormal choose_normal(Vec n, Vec normal, Vec wo, Float u) {
  constexpr float least = 0x1p-10f, most = 0.25f;
  const Float apart = sqrt(length_squared(n - normal));
  const Float p = select(apart > Float(0.f), min(max(apart, Float(least)), Float(most)), Float(0.f));
  const Mask open = dot(n, wo) > Float(0.f), geometric = ~open | (u < p);
  const Float weight = Float(1.f) / select(geometric, p, Float(1.f) - p);
  return {select(geometric, normal, n), geometric, select(open, weight, Float(1.f))};
}

/// What the normals change in the throughput of a path from a light that scatters from wo to wi, which is
/// `local` in the frame of the chosen normal. Seen from the camera, light comes from wo (Veach 1997, section
/// 5.3). `n`: as for choose_normal.
CASTRAY_INLINE Float shading_normal_factor(const Shading& shading, const ScatteringNormal& chosen, Vec n,
                                           Vec wo, Vec wi, Vec local) {
  const Float factor = abs(dot(shading.normal, wi) * shading.wo.z) /
                       max(abs(dot(shading.normal, wo) * local.z), Float(0x1p-60f));
  const Mask shows = shows_shading_normal(n, shading.normal, wi);
  const Mask seen = (shows & ~chosen.geometric) | (~shows & chosen.geometric);
  return select(seen, factor * chosen.weight, Float(0.f));
}

}  // namespace castray::CASTRAY_ISA
