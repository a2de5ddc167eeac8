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

  /// `facets` include all emitting triangles. `by_importance`: choose lights by importance for the
  /// receiver, not by power.
  LightTable(const Scene& scene, const std::vector<Facet>& facets, bool by_importance, int threads);

  /// Points into this. What is not of area lights is left 0.
  LightList list() const;

  /// Area pdf of points on `material`, whose emission has this mean, under power-proportional light sampling.
  float density(const Material& material, const Vec3d& mean_emission) const;

 private:
  std::vector<KernelLight> lights_;
  double power_ = 0;  ///< over pi, of all
  LightTree tree_;    ///< empty: chosen by power
};

}  // namespace castray
