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
      SurfaceValues<double> values(m);
      LobeTables& lobes = lobes_.emplace_back();
      if (has_lobe_table(m) && !has_lobe_rows(m))
        lobes.own = &albedos_.of(lobe_widths(m, values.at(slot_alpha)));
      if (m.type == MaterialType::principled && !has_clearcoat_rows(m))
        lobes.clearcoat = &albedos_.of({clearcoat_alpha(m.clearcoat_roughness)});
      bsdfs_.push_back(make(m, values, lobes_of(bsdfs_.size(), values)));
    }
  }

  /// Where no image changes it.
  const Bsdf<T>& operator[](std::size_t material) const { return bsdfs_[material]; }

  /// Where its parameters have these values.
  Bsdf<T> at(std::size_t material, const SurfaceValues<T>& values) const {
    SurfaceValues<double> exact(values);
    const LobeTables lobes = lobes_of(material, exact);
    return make(materials_[material], exact, lobes);
  }

 private:
  /// The tables of a material's lobes; rounds their widths where an image gives them.
  LobeTables lobes_of(std::size_t material, SurfaceValues<double>& values) const {
    LobeTables lobes = lobes_[material];
    if (has_lobe_rows(materials_[material])) {
      const int row = LobeAlbedoRows::row_of(values.at(slot_alpha));
      values.at(slot_alpha) = LobeAlbedoRows::alpha_of(row);
      lobes.own = &LobeAlbedoRows::all()[row];
    }
    if (has_clearcoat_rows(materials_[material])) {
      const int row = clearcoat_row(values.at(slot_clearcoat_roughness));
      values.at(slot_clearcoat_roughness) = static_cast<double>(row) / LobeAlbedoRows::steps;
      lobes.clearcoat = &LobeAlbedoRows::all()[row];
    }
    return lobes;
  }

  static Bsdf<T> make(const Material& m, const SurfaceValues<double>& values, const LobeTables& lobes) {
    return make_one_of(static_cast<const AnyBsdf<T>*>(nullptr), m, values, lobes);
  }

  template <class First, class... Others>
  static Bsdf<T> make_one_of(const std::variant<First, Others...>*, const Material& m,
                             const SurfaceValues<double>& values, const LobeTables& lobes) {
    Bsdf<T> bsdf = First::make(values, m, lobes);
    ((m.type == Others::descriptor().type ? void(bsdf = Others::make(values, m, lobes)) : void()), ...);
    return bsdf;
  }

  std::vector<Material> materials_;
  std::vector<Bsdf<T>> bsdfs_;
  LobeAlbedos albedos_;
  std::vector<LobeTables> lobes_;  ///< of each material, without rows
};

}  // namespace castray
