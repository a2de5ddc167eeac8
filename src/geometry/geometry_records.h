#pragma once

#include <stdint.h>

#include "geometry/facet_records.h"
#include "geometry/instance_records.h"
#include "geometry/wide_bvh_view.h"

// A scene's geometry as kernels read it: plain data, the same for every instruction set.

namespace castray {

/// Triangles as the scene holds them; what a hit in the tree refers to.
struct TriangleTable {
  const float* positions;          ///< x, y, z of each vertex
  const uint32_t* corners;         ///< three of each triangle
  const uint32_t* materials;       ///< 16 bits a triangle, two in a word, the even one low
  const float* normals;            ///< x, y, z
  const uint32_t* normal_corners;  ///< three of each triangle, 0xffffffff: none; or null
  const float* uvs;                ///< u, v
  const uint32_t* uv_corners;      ///< likewise
  const float* colors;             ///< red, green, blue
  const uint32_t* color_corners;   ///< likewise
};

/// All of a scene as one flat list of facets.
struct FlatList {
  FacetList facets;
  FacetList blockers;  ///< those that can lie between two points of the scene, or before its environment
  BlockerList blocker_fields;
  float camera_slack;  ///< list_slack for rays from the camera
};

/// Where a ray meets a triangle, and its direction in scene space, of any length.
struct PartialHit {
  uint32_t triangle, instance;  ///< instance: of an InstanceTree; no_hit for other geometry
  float b1, b2;
  float direction[3];
};

/// What of the points of a part of a triangle is there.
enum CoverageCell : uint32_t { cell_missing, cell_there, cell_mixed };
inline constexpr uint32_t no_coverage_grid = ~0u;

/// Triangles that are only partly there. A point of one is there in some worlds and not in others, with the
/// probability of its coverage; different points independently of each other. In each world the scene is an
/// ordinary one with holes. A window's coverage depends on the ray's direction: it is what does not pass.
struct PartialTriangles {
  const uint32_t* triangles;  ///< a bit for each, the lowest first; null: all are wholly there
  float (*coverage)(const void* self, const PartialHit& hit);
  const void* self;
  /// Multiplies colours by what is left of them where a ray passes, over what is of the one that passes best.
  /// Null: of all colours the same is left everywhere.
  void (*tint)(const void* self, const PartialHit& hit, float* red, float* green, float* blue);
  bool met_once;  ///< a ray meets each of them once: the tree has none twice
  /// Of a triangle whose coverage does not depend on the direction, a grid of CoverageCell over b1 and b2, as
  /// in CoverageCells. Side 0: there are none.
  uint32_t grid_side = 0;
  const uint32_t *grids = nullptr, *cells = nullptr;
};

/// All of a scene as a tree of triangles.
struct TriangleTree {
  WideBvhView bvh;  ///< without meaning where the scene is held as an InstanceTree
  TriangleTable triangles;
  PartialTriangles partial;
  bool has_surface;  ///< a part of the triangles is a ClosedSurface
  WideBvhView rim;   ///< the free edges of that
};

/// A scene is held as one of the three; the last shares the tables of the second.
struct SceneGeometry {
  FlatList list;
  TriangleTree tree;
  InstanceTree instances;
};

}  // namespace castray
