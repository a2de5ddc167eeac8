#include "wavefront/host_rays.h"

namespace castray {

namespace {

/// A vector of an object's space in scene space.
Vec3d moved(const SceneInstance& instance, const Vec3d& v) {
  const auto& rows = instance.rows;
  return {dot(Vec3d(rows[0]), v), dot(Vec3d(rows[1]), v), dot(Vec3d(rows[2]), v)};
}

}  // namespace

void closest_hits(const KernelApi& kernel, const KernelSceneData& data, bool from_camera,
                  const RayBatch& rays) {
  if (data.bvh) return kernel.bvh_closest(data.bvh->view(), rays);
  if (data.instances) return kernel.instances_closest(data.instances->view(), rays);
  const FlatList& list = data.view.geometry.list;
  kernel.facets_closest(list.facets, from_camera ? list.camera_slack : list_slack, rays);
}

void occluded_segments(const KernelApi& kernel, const KernelSceneData& data, const ShadowBatch& rays) {
  if (data.bvh) return kernel.bvh_occluded(data.bvh->view(), rays);
  if (data.instances) return kernel.instances_occluded(data.instances->view(), rays);
  kernel.facets_occluded(data.view.geometry.list.blockers, segment_slack, rays);
}

SurfaceHit surface_hit(const Scene& scene, const KernelSceneData& data, const Hit<float>& hit) {
  if (data.is_list()) {
    const Facet& f = data.facets.facets[hit.triangle];
    return {{f.normal[0], f.normal[1], f.normal[2]}, f.material};
  }
  const Index3& t = scene.triangles[hit.triangle];
  const Vec3d v0(scene.positions[t[0]]);
  Vec3d e1 = Vec3d(scene.positions[t[1]]) - v0, e2 = Vec3d(scene.positions[t[2]]) - v0;
  double side = 1;
  if (hit.instance < scene.instances.size()) {
    const SceneInstance& instance = scene.instances[hit.instance];
    side = dot(moved(instance, {1, 0, 0}), cross(moved(instance, {0, 1, 0}), moved(instance, {0, 0, 1})));
    e1 = moved(instance, e1);
    e2 = moved(instance, e2);
  }
  return {Vec3f(normalize(cross(e1, e2)) * (side < 0 ? -1.0 : 1.0)), scene.triangle_material[hit.triangle]};
}

}  // namespace castray
