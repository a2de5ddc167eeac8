#pragma once

#include <optional>
#include <vector>

#include "castray/scene.h"
#include "geometry/facet_records.h"
#include "lights/emission_cells.h"
#include "lights/light_records.h"
#include "lights/light_regions.h"
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

  /// Nodes of the cut; 0 or 1 where lights are not chosen by importance.
  std::size_t nodes() const { return tree_.cut().size(); }
  /// The lights of a node, side by side: from first_of(node) to first_of(node + 1).
  std::uint32_t first_of(std::size_t node) const;
  /// Of each node, its share of all power.
  std::vector<double> power_shares() const;
  const std::vector<KernelLight>& lights() const { return lights_; }

  /// Makes the choice of lights know regions. `facets` as at construction; `list`: rays hit facets, not
  /// triangles, of which there are `triangles`.
  void use(LightRegionTable regions, const std::vector<Facet>& facets, bool list, std::size_t triangles);

  /// Area pdf of points on `material`, whose emission has this mean, under power-proportional light sampling;
  /// where triangles have cells, to be multiplied by theirs.
  float density(const Material& material, const Vec3d& mean_emission) const;

 private:
  EmissionCells cells_;
  std::vector<KernelLight> lights_;
  double power_ = 0;  ///< over pi, of all
  LightTree tree_;    ///< empty: chosen by power
  std::optional<LightRegionTable> regions_;
  std::vector<std::uint32_t> node_of_primitive_;
};

}  // namespace castray
