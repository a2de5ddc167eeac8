#pragma once

#include "castray/render_options.h"
#include "castray/scene.h"

// Multiple importance sampling of emitters, by light points and by the BSDF's directions (Veach and Guibas
// 1995). It lies between the balance and the cutoff heuristic (Veach 1997, section 9.2.3): where light
// sampling is at least as dense, it has all of the emission, as light points are stratified and hits are
// not; elsewhere it has light / bsdf of it. So no light point brings more than Le f cos / max(light, bsdf),
// which is bounded as the balance heuristic's is, and away from lights nothing is lost to chance hits.
//
// `light` and `bsdf`: densities with which the two find the same point, in the same measure; expected numbers
// of samples where one of them takes several.

namespace castray {

template <class T>
T light_share(T light, T bsdf) {
  return light < bsdf ? light / bsdf : T(1);
}

/// 1 - light_share.
template <class T>
T bsdf_share(T light, T bsdf) {
  return light < bsdf ? (bsdf - light) / bsdf : T(0);
}

/// Whether light and BSDF sampling share emission: as asked, or automatically unless light sampling would
/// have all of it everywhere, and where an image of the environment is sampled. `bsdf_samples`: most BSDF
/// samples of a point to one light point.
bool uses_mis(Switch mis, const Scene& scene, double bsdf_samples);

}  // namespace castray
