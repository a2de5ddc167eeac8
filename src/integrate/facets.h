#pragma once

#include <vector>

#include "castray/scene.h"
#include "kernels/api.h"

namespace castray {

/// The flat list's facets, with the storage that the kernels' views point into.
struct Facets {
  std::vector<Facet> facets;    ///< all of the scene, sorted by axis
  std::vector<Facet> blockers;  ///< those that can lie between two points of the scene, sorted by axis
  std::vector<float> blocker_fields;

  FacetList list() const;
  FacetList blocker_list() const;
  BlockerList blocker_field_list() const;
};

/// Merges pairs of triangles that form a convex coplanar quad of one material, and drops from the blockers
/// every facet that has the whole scene on one side of its plane: nothing can be behind it.
Facets make_facets(const Scene& scene);

/// The facets of the emitting triangles alone.
std::vector<Facet> emitting_facets(const Scene& scene);

}  // namespace castray
