#include "scene/named_metals.h"

namespace castray {

Vec3d reflectance_of_index(const Vec3d& eta, const Vec3d& k) {
  const Vec3d one(1);
  return ((eta - one) * (eta - one) + k * k) / ((eta + one) * (eta + one) + k * k);
}

const std::vector<NamedMetal>& named_metals() {
  static const std::vector<NamedMetal> metals{
      {"silver", {0.989, 0.984, 0.978}}, {"gold", {1.0, 0.728, 0.365}},
      {"copper", {0.932, 0.623, 0.522}}, {"aluminium", {0.916, 0.923, 0.924}},
      {"iron", {0.530, 0.513, 0.494}},   {"chromium", {0.550, 0.556, 0.554}},
  };
  return metals;
}

}  // namespace castray
