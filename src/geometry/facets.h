#pragma once

#include <vector>

#include "castray/scene.h"
#include "geometry/facet_records.h"
#include "geometry/list.h"

namespace castray {

/// The flat list's facets, with the storage that the kernels' views point into.
struct Facets {
  std::vector<Facet> facets;    ///< all of the scene, sorted by axis
  std::vector<Facet> blockers;  ///< those that can lie before light, sorted by axis
  std::vector<float> blocker_fields;

  FacetList list() const;
  FacetList blocker_list() const;
  BlockerList blocker_field_list() const;
};

/// Merges pairs of triangles that form a convex coplanar quad of one material, and drops from the blockers
/// every facet that has the whole scene on one side of its plane: nothing can be behind it, if there is no
/// environment and no light without size.
Facets make_facets(const Scene& scene);

/// Hits on facets by the reference's test of their triangles, in double: watertight, and right about which of
/// two facets that share an edge is in front. The scene must outlive it.
class FacetsInDouble {
 public:
  FacetsInDouble(const Scene& scene, const std::vector<Facet>& facets);
  ExactFacets view() const { return {this, closest, occluded}; }

 private:
  static void closest(const void* self, const float origin[3], const float direction[3], float& t,
                      std::uint32_t& facet);
  static bool occluded(const void* self, const float origin[3], const float direction[3]);

  TriangleList triangles_;
  std::vector<std::uint32_t> facet_of_;  ///< by triangle
};

/// The facets of the emitting triangles alone.
std::vector<Facet> emitting_facets(const Scene& scene);

}  // namespace castray
