#pragma once

#include <cmath>

#include "castray/scene.h"

namespace castray {

/// What a dielectric's interior absorbs, where it leaves `color` of white light after `distance`; each
/// component in (0,1], distance > 0 (Beer and Lambert's law, as glTF's KHR_materials_volume says it).
inline Vec3d absorption_of(const Vec3d& color, double distance) {
  return Vec3d(-std::log(color.x), -std::log(color.y), -std::log(color.z)) / distance;
}

/// The bodies of dielectrics that a path is in: the innermost, and the one around it. Paths begin outside of
/// all. A body around two others is forgotten in the innermost, and remembered where its surface is hit from
/// within.
class Media {
 public:
  void enter(std::uint16_t material) { outer_ = inner_, inner_ = material + 1u; }
  void leave() { inner_ = outer_, outer_ = 0; }
  /// A ray hit this body's surface from within.
  void find(std::uint16_t material) { inner_ = material + 1u; }

  /// What light keeps over a distance in scene space.
  template <class T>
  Vec3<T> transmittance(const Scene& scene, T distance) const {
    if (inner_ == 0) return Vec3<T>(1);
    const Vec3<T> absorption(scene.materials[inner_ - 1].absorption * scene.unit);
    const auto kept = [distance](T a) { return a > 0 ? std::exp(-a * distance) : T(1); };
    return {kept(absorption.x), kept(absorption.y), kept(absorption.z)};
  }

 private:
  std::uint32_t inner_ = 0, outer_ = 0;  ///< 1 + material; 0: none
};

}  // namespace castray
