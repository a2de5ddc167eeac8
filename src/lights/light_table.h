#pragma once

#include <vector>

#include "castray/scene.h"
#include "geometry/facet_records.h"
#include "lights/light_records.h"
#include "lights/light_tree.h"

namespace castray {

/// The lights of a scene as kernels read them.
class LightTable {
 public:
  LightTable() = default;

  /// `facets` hold the scene's emitting triangles. `by_importance`: lights are chosen by what they may bring
  /// to a point, instead of by power.
  LightTable(const Scene& scene, const std::vector<Facet>& facets, bool by_importance, int threads);

  /// Points into this. What is not of area lights is left 0.
  LightList list() const;

  /// Pdf, per area, of a point on a surface of `material`, which emits `mean_emission` on the mean, by light
  /// sampling that chooses by power.
  float density(const Material& material, const Vec3d& mean_emission) const;

 private:
  std::vector<KernelLight> lights_;
  double power_ = 0;  ///< over pi, of all
  LightTree tree_;    ///< empty: chosen by power
};

}  // namespace castray
