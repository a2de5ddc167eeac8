#include "geometry/wide_bvh_lanes.h"

#include "geometry/bvh_traverse_lanes.h"

namespace castray::CASTRAY_ISA {
namespace {

/// Where the hits of a group's rays go.
struct Hits {
  float* t;
  uint32_t* triangle;
  float *b1, *b2;
};

template <bool any, class Counts, class Batch>
CASTRAY_INLINE void trace(const WideBvhView& bvh, const Counts& counts, const Batch& rays, uint32_t first,
                          uint32_t count, RayGroup& group, float* stack_t, uint32_t* stack_child,
                          const Hits& hits) {
  prepare_rays(group, bvh, rays, first, count);
  for (uint32_t i = 0; i < count; ++i) {
    hits.t[i] = __builtin_inff();
    hits.triangle[i] = no_hit;
    hits.b1[i] = hits.b2[i] = 0;
  }
  if (bvh.triangles > 0) trace_group<any>(bvh, counts, group, count, stack_t, stack_child, hits);
}

constexpr uint32_t slots = 32;

template <class Counts>
CASTRAY_INLINE void find_closest(const WideBvhView& bvh, const Counts& counts, const RayBatch& rays) {
  const uint32_t room = slots * (7u * (uint32_t)bvh.depth + 9);
  float* const stack_t = (float*)__builtin_alloca(room * sizeof(float));
  uint32_t* const stack_child = (uint32_t*)__builtin_alloca(room * sizeof(uint32_t));
  RayGroup group;
  for (uint32_t first = 0; first < rays.count; first += group_size) {
    const uint32_t left = rays.count - first, count = left < group_size ? left : group_size;
    trace<false>(bvh, counts.from(first), rays, first, count, group, stack_t, stack_child,
                 {rays.t + first, rays.triangle + first, rays.b1 + first, rays.b2 + first});
  }
}

template <class Counts>
CASTRAY_INLINE void find_occluded(const WideBvhView& bvh, const Counts& counts, const ShadowBatch& rays) {
  const uint32_t room = slots * (7u * (uint32_t)bvh.depth + 9);
  float* const stack_t = (float*)__builtin_alloca(room * sizeof(float));
  uint32_t* const stack_child = (uint32_t*)__builtin_alloca(room * sizeof(uint32_t));
  RayGroup group;
  float t[group_size], b1[group_size], b2[group_size];
  uint32_t triangle[group_size];
  for (uint32_t first = 0; first < rays.count; first += group_size) {
    const uint32_t left = rays.count - first, count = left < group_size ? left : group_size;
    trace<true>(bvh, counts.from(first), rays, first, count, group, stack_t, stack_child,
                {t, triangle, b1, b2});
    for (uint32_t i = 0; i < count; ++i) rays.occluded[first + i] = triangle[i] != no_hit;
  }
}

}  // namespace

void bvh_closest(const WideBvhView& bvh, const RayBatch& rays) { find_closest(bvh, AllThere{}, rays); }

void bvh_closest(const WideBvhView& bvh, const PartlyThere& there, const RayBatch& rays) {
  const PartialHits hits{there.partial, RayDirections::of(rays)};
  if (rays.presence.key) return find_closest(bvh, ThereForRays{hits, rays.presence}, rays);
  find_closest(bvh, ThereInWorld{hits, there.world}, rays);
}

void bvh_occluded(const WideBvhView& bvh, const ShadowBatch& rays) { find_occluded(bvh, AllThere{}, rays); }

void bvh_occluded(const WideBvhView& bvh, const PartlyThere& there, const ShadowBatch& rays) {
  const PartialHits hits{there.partial, RayDirections::of(rays)};
  if (!rays.kept) return find_occluded(bvh, ThereInWorld{hits, there.world}, rays);
  find_occluded(bvh, begin_thinning(there.partial, rays), rays);
}

void bvh_tint(const WideBvhView& bvh, const PartialTriangles& partial, const TintBatch& rays) {
  find_occluded(bvh, Tinting::of(partial, rays), segments_of(rays));
}

}  // namespace castray::CASTRAY_ISA
