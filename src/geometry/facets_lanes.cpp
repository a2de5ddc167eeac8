#include "geometry/facets_lanes.h"

#include "geometry/facet_list_lanes.h"

namespace castray::CASTRAY_ISA {

namespace {

/// Stores the first `lanes`.
template <class T, class V>
CASTRAY_INLINE void store_some(T* to, V v, uint32_t lanes) {
  if (lanes == width) return store(to, v);
  for (uint32_t l = 0; l < lanes; ++l) to[l] = lane(v, (int)l);
}

/// Calls use(i, o, d, lanes) for each `width` rays of a batch.
template <class Batch, class Use>
CASTRAY_INLINE void for_each_vector(const Batch& rays, Use use) {
  const auto at = [&](const float* p, uint32_t i) { return load_padded(p, i, rays.count); };
  for (uint32_t i = 0; i < rays.count; i += width) {
    const Vec o{at(rays.ox, i), at(rays.oy, i), at(rays.oz, i)};
    const Vec d{at(rays.dx, i), at(rays.dy, i), at(rays.dz, i)};
    use(i, o, d, rays.count - i < width ? rays.count - i : width);
  }
}

}  // namespace

void facets_closest(const FacetList& list, float slack, const RayBatch& rays) {
  for_each_vector(rays, [&](uint32_t i, const Vec& o, const Vec& d, uint32_t lanes) {
    const ListHit hit = list_closest(list, o, d, Float(slack));
    store_some(rays.t + i, hit.t, lanes);
    store_some(rays.triangle + i, hit.facet, lanes);
    store_some(rays.b1 + i, Float(0.f), lanes);
    store_some(rays.b2 + i, Float(0.f), lanes);
  });
}

void facets_occluded(const FacetList& list, float slack, const ShadowBatch& rays) {
  for_each_vector(rays, [&](uint32_t i, const Vec& o, const Vec& d, uint32_t lanes) {
    uint32_t blocked = bits(list_occluded(list, o, d, Float(slack)));
    for (uint32_t l = 0; l < lanes; ++l, blocked >>= 1) rays.occluded[i + l] = blocked & 1;
  });
}

}  // namespace castray::CASTRAY_ISA
