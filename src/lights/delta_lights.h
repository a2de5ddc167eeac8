#pragma once

#include <cmath>
#include <limits>
#include <vector>

#include "castray/scene.h"
#include "lights/light_records.h"

namespace castray {

/// What a light without size sends to a point.
template <class T>
struct DeltaSample {
  Vec3<T> wi;          ///< unit, to the light
  T distance;          ///< to it; infinity for a directional one
  Vec3<T> irradiance;  ///< of a surface that faces it, if nothing is between
};

/// The share of its intensity that a spot light sends into a direction at this cosine to its axis.
template <class T>
T spot_share(const DeltaLight& light, T cosine) {
  const T outer = static_cast<T>(light.cos_outer), width = static_cast<T>(light.cos_inner) - outer;
  if (!(cosine > outer)) return 0;
  const T share = (cosine - outer) / width;
  return share < 1 ? share * share : T(1);
}

template <class T>
DeltaSample<T> sample_delta(const DeltaLight& light, const Vec3<T>& p) {
  const Vec3<T> intensity(light.intensity), axis(light.direction);
  if (light.kind == DeltaLight::Kind::directional)
    return {-axis, std::numeric_limits<T>::infinity(), intensity};
  const Vec3<T> towards = Vec3<T>(light.position) - p;
  const T distance = length(towards);
  if (!(distance > 0)) return {axis, 0, {}};
  const Vec3<T> wi = towards / distance;
  const T share = light.kind == DeltaLight::Kind::spot ? spot_share(light, -dot(axis, wi)) : T(1);
  return {wi, distance, intensity * (share / (distance * distance))};
}

std::vector<KernelDelta> kernel_deltas(const std::vector<DeltaLight>& lights);

}  // namespace castray
