#pragma once

#include <vector>

#include "castray/scene.h"
#include "materials/bsdf.h"

namespace castray {

/// The BSDFs of a scene's materials.
template <class T>
class MaterialTable {
 public:
  explicit MaterialTable(const std::vector<Material>& materials) : materials_(materials) {
    bsdfs_.reserve(materials.size());
    for (const Material& m : materials) {
      const SurfaceValues<double> values(m);
      lobes_.push_back(descriptor_of(m.type).finish ? &albedos_.of(values.alpha) : nullptr);
      bsdfs_.push_back(make(m, values, lobes_.back()));
    }
  }

  /// Where no image changes it.
  const Bsdf<T>& operator[](std::size_t material) const { return bsdfs_[material]; }

  /// Where its parameters have these values.
  Bsdf<T> at(std::size_t material, const SurfaceValues<T>& values) const {
    return make(materials_[material], SurfaceValues<double>(values), lobes_[material]);
  }

 private:
  static Bsdf<T> make(const Material& m, const SurfaceValues<double>& values, const LobeAlbedo* lobe) {
    return make_one_of(static_cast<const AnyBsdf<T>*>(nullptr), m, values, lobe);
  }

  template <class First, class... Others>
  static Bsdf<T> make_one_of(const std::variant<First, Others...>*, const Material& m,
                             const SurfaceValues<double>& values, const LobeAlbedo* lobe) {
    Bsdf<T> bsdf = First::make(values, m, lobe);
    ((m.type == Others::descriptor().type ? void(bsdf = Others::make(values, m, lobe)) : void()), ...);
    return bsdf;
  }

  std::vector<Material> materials_;
  std::vector<Bsdf<T>> bsdfs_;
  LobeAlbedos albedos_;
  std::vector<const LobeAlbedo*> lobes_;
};

}  // namespace castray
