#include "geometry/facets_lanes.h"
#include "geometry/instance_tree_lanes.h"
#include "geometry/wide_bvh_lanes.h"
#include "lights/light_choice_batch_lanes.h"
#include "materials/bsdf_batch_lanes.h"
#include "wavefront/render_tiles_lanes.h"
#include "wavefront/tiles_lanes.h"

namespace castray::CASTRAY_ISA {

#define CASTRAY_TEXT_(x) #x
#define CASTRAY_TEXT(x) CASTRAY_TEXT_(x)

namespace {

void sample_block(bool sobol, uint32_t key, uint32_t index, uint32_t block, float* u) {
  const Numbers<4> n = draw<4>(sobol, {Uint(key), Uint(index)}, block);
  for (int d = 0; d < 4; ++d) u[d] = lane(n.u[d], 0);
}

void all_closest(const InstanceTree& tree, const RayBatch& rays) { instances_closest(tree, nullptr, rays); }
void all_occluded(const InstanceTree& tree, const ShadowBatch& rays) {
  instances_occluded(tree, nullptr, rays);
}

constexpr uint32_t instances = feature_bvh | feature_materials | feature_detail | feature_instances;

KernelApi with_instances(KernelApi api) {
  api.render_tiles[instances] = render_tiles_instances;
  return api;
}

}  // namespace

const KernelApi& kernel_api() {
  static const KernelApi api =
      with_instances({CASTRAY_TEXT(CASTRAY_ISA),
                      width,
                      sizeof(Scratch),
                      {render_tiles_list_diffuse, render_tiles_bvh_diffuse, render_tiles_list,
                       render_tiles_bvh, nullptr, nullptr, nullptr, render_tiles_bvh_detail},
                      {nullptr, nullptr, trace_light_paths_list, trace_light_paths_bvh, nullptr, nullptr,
                       nullptr, trace_light_paths_bvh_detail},
                      sample_block,
                      bvh_closest,
                      bvh_occluded,
                      all_closest,
                      all_occluded,
                      facets_closest,
                      facets_occluded,
                      evaluate_bsdfs,
                      choose_lights});
  return api;
}

}  // namespace castray::CASTRAY_ISA
