#include "geometry/instance_tree_lanes.h"

#include "geometry/instance_traverse_lanes.h"

namespace castray::CASTRAY_ISA {
namespace {

/// Traces all groups of a batch; `hits_of` says where those of the group from a ray on go, `done` gets each
/// group.
template <bool any, class Counts, class Batch, class HitsOf, class Done>
CASTRAY_INLINE void trace_batch(const InstanceTree& tree, const Counts& counts, const Batch& rays,
                                const HitsOf& hits_of, const Done& done) {
  using Traversal = InstanceTraversal<any, Counts, Batch>;
  const uint32_t room = Traversal::slots * Traversal::room_of(tree);
  float* const stack_t = (float*)__builtin_alloca(room * sizeof(float));
  uint32_t* const stack_child = (uint32_t*)__builtin_alloca(room * sizeof(uint32_t));
  Traversal traversal(tree, counts, rays, stack_t, stack_child);
  RayGroup group;
  for (uint32_t first = 0; first < rays.count; first += group_size) {
    const uint32_t left = rays.count - first, count = left < group_size ? left : group_size;
    const InstanceHits hits = hits_of(first);
    for (uint32_t i = 0; i < count; ++i) {
      hits.t[i] = __builtin_inff();
      hits.triangle[i] = hits.instance[i] = no_hit;
      hits.b1[i] = hits.b2[i] = 0;
    }
    prepare_rays(group, tree.top, rays, first, count, Slack{tree.slack});
    traversal.run(group, first, count, hits);
    done(first, count);
  }
}

template <class Counts>
CASTRAY_INLINE void find_closest(const InstanceTree& tree, const Counts& counts, const RayBatch& rays) {
  trace_batch<false>(
      tree, counts, rays,
      [&](uint32_t i) {
        return InstanceHits{rays.t + i, rays.triangle + i, rays.instance + i, rays.b1 + i, rays.b2 + i};
      },
      [](uint32_t, uint32_t) {});
}

template <class Counts>
CASTRAY_INLINE void find_occluded(const InstanceTree& tree, const Counts& counts, const ShadowBatch& rays) {
  float t[group_size], b1[group_size], b2[group_size];
  uint32_t triangle[group_size], instance[group_size];
  trace_batch<true>(
      tree, counts, rays,
      [&](uint32_t) {
        return InstanceHits{t, triangle, instance, b1, b2};
      },
      [&](uint32_t first, uint32_t count) {
        for (uint32_t i = 0; i < count; ++i) rays.occluded[first + i] = triangle[i] != no_hit;
      });
}

}  // namespace

void instances_closest(const InstanceTree& tree, const PartlyThere* there, const RayBatch& rays) {
  if (!there) return find_closest(tree, AllThere{}, rays);
  const PartialHits hits{there->partial, RayDirections::of(rays)};
  if (rays.presence.key) return find_closest(tree, ThereForRays{hits, rays.presence}, rays);
  find_closest(tree, ThereInWorld{hits, there->world}, rays);
}

void instances_occluded(const InstanceTree& tree, const PartlyThere* there, const ShadowBatch& rays) {
  if (!there) return find_occluded(tree, AllThere{}, rays);
  const PartialHits hits{there->partial, RayDirections::of(rays)};
  if (!rays.kept) return find_occluded(tree, ThereInWorld{hits, there->world}, rays);
  find_occluded(tree, begin_thinning(there->partial, rays), rays);
}

void instances_tint(const InstanceTree& tree, const PartialTriangles& partial, const TintBatch& rays) {
  find_occluded(tree, Tinting::of(partial, rays), segments_of(rays));
}

}  // namespace castray::CASTRAY_ISA
