#pragma once

#include "geometry/facet_shaft_lanes.h"
#include "geometry/facets_lanes.h"
#include "geometry/geometry_records.h"
#include "geometry/surface_point_lanes.h"

namespace castray::CASTRAY_ISA {

/// Geometry as a flat list of facets. Like TreeGeometry, it is all that the stages know of how a scene's
/// surfaces are held: they are templates over one of the two.
class ListGeometry {
 public:
  static constexpr int blocker_corners = 4;         ///< of what a shaft holds
  static constexpr bool has_many_blockers = false;  ///< in a shaft, so that choosing among them pays

  CASTRAY_INLINE explicit ListGeometry(const SceneGeometry& scene) : list_(scene.list) {}

  /// The nearest hit of each ray. Rays start within the scene, or all at the camera. `b1` and `b2` are 0.
  CASTRAY_INLINE void closest(const RayBatch& rays, bool from_camera) const {
    facets_closest(list_.facets, from_camera ? list_.camera_slack : list_slack, rays);
  }

  /// Whether anything is between the ends of each segment, which both lie within the scene.
  CASTRAY_INLINE void occluded(const ShadowBatch& rays) const {
    facets_occluded(list_.blockers, segment_slack, rays);
  }

  /// The point where the ray o + t d was found to hit.
  CASTRAY_INLINE SurfacePoint surface_point(const Vec& o, const Vec& d, const SurfaceHit& hit) const {
    const Facet* facets = list_.facets.facets;
    const Uint record = hit.primitive * uint32_t{facet_floats};
    const Vec normal = gather_vec(facets, &Facet::normal, record);
    const Vec on_ray = fma(d, hit.t, o);
    const Float above = dot(normal, on_ray) - gather(facets, &Facet::offset, record);
    return {fma(normal, -above, on_ray), normal, gather(facets, &Facet::error, record),
            gather(facets, &Facet::material, record)};
  }

  /// Where a segment from `from` to the surface point p must end so that p's own surface does not block it; p
  /// is offset by its error to the side of `normal`. A facet's error has the test's in it.
  CASTRAY_INLINE Vec far_end(const Vec& p, const Vec& /*normal*/, const Vec& /*from*/) const { return p; }

  /// What may block the segments from y to the points of a box. False: too much to look at.
  CASTRAY_INLINE bool make_shaft(const Vec& y, const Box& box, ShaftBudget& /*budget*/, Shaft& out) const {
    facet_shaft(list_.blocker_fields, y, box, out);
    return true;
  }

 private:
  const FlatList& list_;
};

}  // namespace castray::CASTRAY_ISA
