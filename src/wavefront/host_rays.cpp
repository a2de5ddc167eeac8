#include "wavefront/host_rays.h"

namespace castray {

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
  bool mirrored = false;
  if (hit.instance < scene.instances.size()) {
    const SceneInstance& instance = scene.instances[hit.instance];
    mirrored = instance.mirrors();
    e1 = instance.linear(e1);
    e2 = instance.linear(e2);
  }
  const Vec3d normal = normalize(cross(e1, e2));
  return {Vec3f(mirrored ? -normal : normal), scene.triangle_material[hit.triangle]};
}

}  // namespace castray
