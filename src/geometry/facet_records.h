#pragma once

#include <stdint.h>

// A flat list of facets as kernels read it: plain data, the same for every instruction set.

namespace castray {

/// A convex coplanar quad or a triangle of the flat list. Point p of its plane is inside where every
/// edge . (p[u], p[v], 1) >= 0; edges are scaled so that this is a distance in the projection onto axes u and
/// v.
struct Facet {
  float normal[3];  ///< unit; to the counter-clockwise side
  float offset;     ///< normal . p of the plane's points
  float edge[4][3];
  float error;  ///< bound of the distance between a computed hit point and the exact facet
  uint32_t material;
  float corner[4][3];
  uint32_t triangle[2];  ///< of the scene; equal for a triangle
};
inline constexpr int facet_floats = sizeof(Facet) / sizeof(float);

/// An exact test, for rays near edges: closest hit, where facet 0xffffffff is a miss; and whether the segment
/// from the origin along the direction is blocked.
struct ExactFacets {
  const void* of;
  void (*closest)(const void* of, const float origin[3], const float direction[3], float& t, uint32_t& facet);
  bool (*occluded)(const void* of, const float origin[3], const float direction[3]);
};

/// Facets sorted by axis: those of axis a are facets[first[a]] to facets[first[a + 1] - 1].
struct FacetList {
  const Facet* facets;
  uint32_t first[4];
  ExactFacets exact;  ///< of the whole scene
};

/// The facets that can lie between two points of the scene, or before light from elsewhere, field by field,
/// padded to a multiple of 16 with copies of the last one.
struct BlockerList {
  const float* corner[4][3];
  const float *center[3], *radius;  ///< of a ball around each
  uint32_t count, padded;
};

/// Bounds of rounding in ray/facet tests: how far a ray of unit direction that starts in the scene may
/// pass a facet's edge and still hit; and for segments, that times the segment's length.
inline constexpr float list_slack = 0x1p-20f, segment_slack = 4 * list_slack;

}  // namespace castray
