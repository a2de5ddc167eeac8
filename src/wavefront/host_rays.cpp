#include "wavefront/host_rays.h"

namespace castray {

void closest_hits(const KernelApi& kernel, const KernelSceneData& data, bool from_camera,
                  const RayBatch& rays) {
  if (data.bvh) return kernel.bvh_closest(data.bvh->view(), rays);
  const FlatList& list = data.view.geometry.list;
  kernel.facets_closest(list.facets, from_camera ? list.camera_slack : list_slack, rays);
}

SurfaceHit surface_hit(const Scene& scene, const KernelSceneData& data, std::uint32_t primitive) {
  if (!data.bvh) {
    const Facet& f = data.facets.facets[primitive];
    return {{f.normal[0], f.normal[1], f.normal[2]}, f.material};
  }
  const Index3& t = scene.triangles[primitive];
  const Vec3d v0(scene.positions[t[0]]);
  const Vec3d normal = cross(Vec3d(scene.positions[t[1]]) - v0, Vec3d(scene.positions[t[2]]) - v0);
  return {Vec3f(normalize(normal)), scene.triangle_material[primitive]};
}

}  // namespace castray
