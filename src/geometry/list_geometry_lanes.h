#pragma once

#include "geometry/facet_shaft_lanes.h"
#include "geometry/facets_lanes.h"
#include "geometry/geometry_records.h"
#include "geometry/placement_lanes.h"
#include "geometry/surface_point_lanes.h"

namespace castray::CASTRAY_ISA {

/// Geometry as a flat list of facets. Stages are templates over a geometry: this, or TreeGeometry with
/// the same members.
class ListGeometry {
 public:
  static constexpr int blocker_corners = 4;         ///< of the pyramids in its shafts
  static constexpr bool has_many_blockers = false;  ///< shafts are long enough to select from

  /// `world`: see PartialTriangles. All facets are wholly there.
  CASTRAY_INLINE ListGeometry(const SceneGeometry& scene, uint32_t /*world*/) : list_(scene.list) {}

  /// Nearest hits. Rays start within the scene or, all of them, at the camera. b1 and b2 become 0.
  CASTRAY_INLINE void closest(const RayBatch& rays, bool from_camera) const {
    facets_closest(list_.facets, from_camera ? list_.camera_slack : list_slack, rays);
  }

  /// Whether each segment between two points of the scene is blocked.
  CASTRAY_INLINE void occluded(const ShadowBatch& rays) const {
    facets_occluded(list_.blockers, segment_slack, rays);
  }

  /// Whether they tell what partial triangles leave of their light (ShadowBatch::kept).
  CASTRAY_INLINE bool thins() const { return false; }

  /// Multiplies colours by what the windows leave that rays pass.
  CASTRAY_INLINE void tint(const TintBatch& /*rays*/) const {}

  /// How what tables hold of a hit's triangle is turned to scene space.
  CASTRAY_INLINE InPlace placement(const SurfaceHit& /*hit*/) const { return {}; }

  /// The surface point where ray o + t d hits.
  CASTRAY_INLINE SurfacePoint surface_point(const Vec& o, const Vec& d, const SurfaceHit& hit) const {
    const Facet* facets = list_.facets.facets;
    const Uint record = hit.primitive * uint32_t{facet_floats};
    const Vec normal = gather_vec(facets, &Facet::normal, record);
    const Vec on_ray = fma(d, hit.t, o);
    const Float above = dot(normal, on_ray) - gather(facets, &Facet::offset, record);
    return {fma(normal, -above, on_ray), normal, gather(facets, &Facet::error, record),
            gather(facets, &Facet::material, record)};
  }

  /// The end point of a segment from `from` to surface point p that p's own surface does not block. p
  /// is already offset by its error to the side of `normal`; a facet's error includes that of the test.
  CASTRAY_INLINE Vec far_end(const Vec& p, const Vec& /*normal*/, const Vec& /*from*/) const { return p; }

  /// Whether make_shaft may leave out triangles that face an apex, if the box's points and the apex see each
  /// other by paths in the hull of the two and of `origin`.
  CASTRAY_INLINE bool may_leave_out(const float (&)[3], const Box&) const { return false; }

  /// The possible blockers between an apex and a box. False: too many. `facing`: see triangle_shaft.
  template <class Apex>
  CASTRAY_INLINE bool make_shaft(const Apex& apex, const Box& box, ShaftBudget& /*budget*/, Shaft& out,
                                 float /*facing*/) const {
    return facet_shaft(list_.blocker_fields, apex, box, out);
  }

 private:
  const FlatList& list_;
};

}  // namespace castray::CASTRAY_ISA
