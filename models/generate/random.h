#pragma once

#include <cmath>
#include <numbers>

#include "castray/vec.h"
#include "core/sequences.h"

namespace castray {

/// Independent numbers in [0,1), one after the other.
class Random {
 public:
  explicit Random(std::uint32_t seed) : seed_(hash32(seed)) {}
  double next() { return hash32(seed_ ^ hash32(count_++)) * 0x1p-32; }
  Vec3d in_cube() {
    const double x = next(), y = next(), z = next();
    return {2 * x - 1, 2 * y - 1, 2 * z - 1};
  }
  Vec3d on_sphere() {
    const double z = 2 * next() - 1, phi = 2 * std::numbers::pi * next(), r = std::sqrt(1 - z * z);
    return {r * std::cos(phi), r * std::sin(phi), z};
  }

 private:
  std::uint32_t seed_, count_ = 0;
};

}  // namespace castray
