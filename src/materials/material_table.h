#pragma once

#include <memory>
#include <vector>

#include "castray/scene.h"
#include "materials/bsdf.h"

namespace castray {

/// The BSDF of each of a scene's materials, textures left out.
template <class T>
class MaterialTable {
 public:
  explicit MaterialTable(const std::vector<Material>& materials) {
    bsdfs_.reserve(materials.size());
    for (const Material& material : materials) bsdfs_.push_back(make(material));
  }

  const Bsdf<T>& operator[](std::size_t material) const { return bsdfs_[material]; }

 private:
  Bsdf<T> make(const Material& m) {
    const Ggx<T> ggx{static_cast<T>(m.alpha), m.correlated_masking};
    switch (m.type) {
      case MaterialType::conductor:
        return Conductor<T>{Vec3<T>(m.reflectance), ggx};
      case MaterialType::dielectric:
        return Dielectric<T>{static_cast<T>(m.ior), ggx};
      case MaterialType::microfacet: {
        albedos_.push_back(std::make_unique<LobeAlbedo>(m.alpha));
        const Vec3d base = m.kd / (Vec3d(1) - albedos_.back()->mean(m.ks));
        return Microfacet<T>{Vec3<T>(base), Vec3<T>(m.ks), ggx, albedos_.back().get()};
      }
      case MaterialType::diffuse:
        break;
    }
    return Diffuse<T>{Vec3<T>(m.kd)};
  }

  std::vector<Bsdf<T>> bsdfs_;
  std::vector<std::unique_ptr<LobeAlbedo>> albedos_;
};

}  // namespace castray
