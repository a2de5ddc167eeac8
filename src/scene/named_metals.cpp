#include "scene/named_metals.h"

#include <algorithm>
#include <cmath>

namespace castray {

namespace {

/// The k with which a metal of this eta has that reflectance straight on.
double k_of(double reflectance, double eta) {
  const double r = std::min(reflectance, 0.999);
  return std::sqrt((r * (eta + 1) * (eta + 1) - (eta - 1) * (eta - 1)) / (1 - r));
}

NamedMetal metal(std::string_view name, const Vec3d& reflectance, const Vec3d& eta) {
  return {name,
          reflectance,
          eta,
          {k_of(reflectance.x, eta.x), k_of(reflectance.y, eta.y), k_of(reflectance.z, eta.z)}};
}

}  // namespace

Vec3d reflectance_of_index(const Vec3d& eta, const Vec3d& k) {
  const Vec3d one(1);
  return ((eta - one) * (eta - one) + k * k) / ((eta + one) * (eta + one) + k * k);
}

const std::vector<NamedMetal>& named_metals() {
  static const std::vector<NamedMetal> metals{
      metal("silver", {0.989, 0.984, 0.978}, {0.05, 0.06, 0.04}),
      metal("gold", {1.0, 0.728, 0.365}, {0.16, 0.42, 1.38}),
      metal("copper", {0.932, 0.623, 0.522}, {0.21, 0.98, 1.17}),
      metal("aluminium", {0.916, 0.923, 0.924}, {1.47, 0.96, 0.62}),
      metal("iron", {0.530, 0.513, 0.494}, {2.91, 2.95, 2.58}),
      metal("chromium", {0.550, 0.556, 0.554}, {3.11, 3.18, 2.32}),
  };
  return metals;
}

}  // namespace castray
