#pragma once

#include "geometry/bvh_shaft_lanes.h"
#include "geometry/geometry_records.h"
#include "geometry/instance_shaft_lanes.h"
#include "geometry/instance_tree_lanes.h"
#include "geometry/placement_lanes.h"
#include "geometry/triangle_table_lanes.h"

namespace castray::CASTRAY_ISA {

/// The point of a hit on an instance. To what rounding does in the object's space comes what it does on the
/// way: to the point and to the triangle's corners, and to the origins of rays that leave the point for the
/// object's space.
CASTRAY_INLINE SurfacePoint instance_point(const TriangleTable& table, const Placed& placed,
                                           const SurfaceHit& hit) {
  const InstanceLanes& at = placed.instance;
  const TriangleShape shape = triangle_shape(table, hit);
  const Vec normal = normalize(placed.normal(shape.normal));
  const Vec size = InstanceLanes::spread(at.to_scene, shape.size);
  const Vec inside = InstanceLanes::spread(at.to_object, size) * Float(8 * 0x1p-24f);
  const Float test = shape.extent * Float(26 * 0x1p-24f);
  const Vec moved = InstanceLanes::spread(at.to_scene, inside + Vec{test, test, test});
  const Vec error = size * Float(18 * 0x1p-24f) + moved + magnitude(at.translation) * Float(10 * 0x1p-24f);
  return {InstanceLanes::product(at.to_scene, shape.p) + at.translation, normal,
          dot(magnitude(normal), error), material_of(table, hit.primitive)};
}

/// Geometry as a tree over instances; see ListGeometry for the members.
class InstanceGeometry {
 public:
  static constexpr int blocker_corners = 3;
  static constexpr bool has_many_blockers = true;

  CASTRAY_INLINE InstanceGeometry(const SceneGeometry& scene, uint32_t world)
      : tree_(scene.instances), table_(scene.tree.triangles), there_{scene.tree.partial, world} {}

  CASTRAY_INLINE void closest(const RayBatch& rays, bool /*from_camera*/) const {
    instances_closest(tree_, there(), rays);
  }

  CASTRAY_INLINE void occluded(const ShadowBatch& rays) const { instances_occluded(tree_, there(), rays); }

  CASTRAY_INLINE bool thins() const { return there_.thins(); }

  CASTRAY_INLINE void tint(const TintBatch& rays) const { instances_tint(tree_, there_.partial, rays); }

  CASTRAY_INLINE Placed placement(const SurfaceHit& hit) const { return {{tree_.instances, hit.instance}}; }

  CASTRAY_INLINE SurfacePoint surface_point(const Vec& /*o*/, const Vec& /*d*/, const SurfaceHit& hit) const {
    return instance_point(table_, placement(hit), hit);
  }

  /// p, offset further by the error of a test over this distance, in whatever object's space.
  CASTRAY_INLINE Vec far_end(const Vec& p, const Vec& normal, const Vec& from) const {
    const Float error = max_component(magnitude(p - from)) * sum_abs(normal) * Float(tree_.slack);
    return fma(normal, error, p);
  }

  CASTRAY_INLINE bool may_leave_out(const float (&)[3], const Box&) const { return false; }

  template <class Apex>
  CASTRAY_INLINE bool make_shaft(const Apex& apex, const Box& box, ShaftBudget& budget, Shaft& out,
                                 float /*facing*/) const {
    return instance_shaft(tree_, there(), apex, box, budget, out);
  }

 private:
  CASTRAY_INLINE const PartlyThere* there() const { return there_.partial.triangles ? &there_ : nullptr; }

  const InstanceTree& tree_;
  const TriangleTable& table_;
  PartlyThere there_;
};

}  // namespace castray::CASTRAY_ISA
