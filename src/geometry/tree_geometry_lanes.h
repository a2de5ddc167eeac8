#pragma once

#include "geometry/bvh_shaft_lanes.h"
#include "geometry/placement_lanes.h"
#include "geometry/triangle_table_lanes.h"
#include "geometry/wide_bvh_lanes.h"

namespace castray::CASTRAY_ISA {

/// Geometry as a tree of triangles; see ListGeometry for the members.
class TreeGeometry {
 public:
  static constexpr int blocker_corners = 3;
  static constexpr bool has_many_blockers = true;

  CASTRAY_INLINE TreeGeometry(const SceneGeometry& scene, uint32_t world)
      : tree_(scene.tree), there_{scene.tree.partial, world} {}

  CASTRAY_INLINE void closest(const RayBatch& rays, bool /*from_camera*/) const {
    has_partial() ? bvh_closest(tree_.bvh, there_, rays) : bvh_closest(tree_.bvh, rays);
  }

  CASTRAY_INLINE void occluded(const ShadowBatch& rays) const {
    has_partial() ? bvh_occluded(tree_.bvh, there_, rays) : bvh_occluded(tree_.bvh, rays);
  }

  CASTRAY_INLINE bool thins() const { return there_.thins(); }

  CASTRAY_INLINE void tint(const TintBatch& rays) const { bvh_tint(tree_.bvh, tree_.partial, rays); }

  CASTRAY_INLINE InPlace placement(const SurfaceHit& /*hit*/) const { return {}; }

  CASTRAY_INLINE SurfacePoint surface_point(const Vec& /*o*/, const Vec& /*d*/, const SurfaceHit& hit) const {
    return triangle_point(tree_.triangles, hit);
  }

  /// p, offset further by the error of a ray/triangle test over this distance.
  CASTRAY_INLINE Vec far_end(const Vec& p, const Vec& normal, const Vec& from) const {
    return fma(normal, error_of_test(max_component(magnitude(p - from)), normal), p);
  }

  template <class Apex>
  CASTRAY_INLINE bool make_shaft(const Apex& apex, const Box& box, ShaftBudget& budget, Shaft& out,
                                 float facing) const {
    return has_partial() ? triangle_shaft(tree_.bvh, there_, apex, box, budget, out, 0)
                         : triangle_shaft(tree_.bvh, AllThere{}, apex, box, budget, out, facing);
  }

  CASTRAY_INLINE bool may_leave_out(const float (&origin)[3], const Box& box) const {
    return tree_.has_surface && clear_of_rim(tree_.rim, origin, box);
  }

 private:
  CASTRAY_INLINE bool has_partial() const { return tree_.partial.triangles; }

  const TriangleTree& tree_;
  PartlyThere there_;
};

}  // namespace castray::CASTRAY_ISA
