#pragma once

#include <array>
#include <cmath>
#include <random>

#include "geometry/ray.h"
#include "materials/bsdf.h"

namespace castray {

// The classic faults of a first path tracer that are more than a line; docs/classic-faults.md.

/// Fault slow_random: an engine, and a question to the operating system, for every number.
inline std::array<float, 4> draw_from_new_engines() {
  std::array<float, 4> u;
  for (float& v : u) {
    std::random_device device;
    std::mt19937 engine(device());
    v = static_cast<float>(engine() >> 8) * 0x1p-24f;
  }
  return u;
}

/// Fault white_specks: the hemisphere sampled uniformly by z = |1 - 2u|, which is exactly 0 for u = 1/2; both
/// the value and the density are then 0, and their quotient is not a number.
template <class T>
BsdfSample<T> sample_uniformly(const Bsdf<T>& bsdf, const Vec3<T>& wo, Point2<T> u) {
  const T z = std::abs(T(1) - 2 * u.x);
  Vec3<T> wi = spherical(z, (T(1) - z) * (T(1) + z), 2 * pi<T> * u.y);
  if (wo.z < 0) wi.z = -wi.z;
  const T pdf = z > 0 ? T(1) / (2 * pi<T>) : T(0);
  return {.weight = bsdf.evaluate(wo, wi) * z / pdf, .wi = wi, .pdf = pdf};
}

}  // namespace castray
