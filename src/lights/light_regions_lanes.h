#pragma once

#include "lights/light_records.h"
#include "simd/vec_lanes.h"

namespace castray::CASTRAY_ISA {

/// The number of the region of a place.
CASTRAY_INLINE Uint region_at(const RegionNode* tree, const Vec& place) {
  constexpr uint32_t stride = sizeof(RegionNode) / sizeof(float);
  Uint at(0u), link = gather(tree, &RegionNode::link, at);
  Mask inner = ~((link & 3u) == Uint(region_leaf));
  while (any(inner)) {
    const Uint axis = link & 3u;
    const Float x = select(axis == Uint(0u), place.x, select(axis == Uint(1u), place.y, place.z));
    const Mask second = gather(tree, &RegionNode::plane, at) <= x;
    const Uint child = (link >> 2) + select(second, Uint(1u), Uint(0u));
    at = select(inner, child * stride, at);
    link = gather(tree, &RegionNode::link, at);
    inner = ~((link & 3u) == Uint(region_leaf));
  }
  return link >> 2;
}

/// Where the tables' row begins for the region of a place, in floats.
CASTRAY_INLINE Uint row_at(const LightRegions& regions, const Vec& place) {
  return region_at(regions.tree, place) * uint32_t{most_light_cut};
}

/// For MIS weights at p, of a point in the unit direction wi on a light of the given node: the pdf of light
/// sampling over that of power-proportional sampling. A function of p, wi and node alone, so that light
/// points and hits are weighed alike.
CASTRAY_INLINE Float relative_density(const LightRegions& regions, const Vec& p, const Vec& wi, Uint node) {
  return gather(regions.density, row_at(regions, fma(wi, Float(light_front), p)) + node);
}

}  // namespace castray::CASTRAY_ISA
