#pragma once

#include <optional>
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
      if (has_lobe_rows(m) && !rows_) rows_.emplace();
      SurfaceValues<double> values(m);
      lobes_.push_back(descriptor_of(m.type).finish && !has_lobe_rows(m) ? &albedos_.of(values.at(slot_alpha))
                                                                         : nullptr);
      bsdfs_.push_back(make(m, values, lobe_of(bsdfs_.size(), values)));
    }
  }

  /// Where no image changes it.
  const Bsdf<T>& operator[](std::size_t material) const { return bsdfs_[material]; }

  /// Where its parameters have these values.
  Bsdf<T> at(std::size_t material, const SurfaceValues<T>& values) const {
    SurfaceValues<double> exact(values);
    const LobeAlbedo* lobe = lobe_of(material, exact);
    return make(materials_[material], exact, lobe);
  }

 private:
  /// The table of a material's lobe, or null; rounds alpha where an image gives it.
  const LobeAlbedo* lobe_of(std::size_t material, SurfaceValues<double>& values) const {
    if (!has_lobe_rows(materials_[material])) return lobes_[material];
    const int row = LobeAlbedoRows::row_of(values.at(slot_alpha));
    values.at(slot_alpha) = LobeAlbedoRows::alpha_of(row);
    return &(*rows_)[row];
  }

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
  std::optional<LobeAlbedoRows> rows_;    ///< where an image gives an alpha
  std::vector<const LobeAlbedo*> lobes_;  ///< of each material, or null
};

}  // namespace castray
