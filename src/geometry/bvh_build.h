#pragma once

#include <vector>

#include "geometry/binning.h"
#include "geometry/bvh_node.h"
#include "geometry/ray.h"

namespace castray {

/// No leaf is deeper, whatever the input: traversal stacks have this room.
inline constexpr int max_bvh_depth = 96;

struct BuildParameters {
  int threads = 1;
  std::uint32_t max_leaf = 8;  ///< most primitives in a leaf
  int leaf_block_log2 = 0;     ///< primitives are tested 2^this at a time: a leaf costs whole blocks
  float traversal_cost = 1;    ///< of visiting a node, over that of testing one block
  double split_share = 0;      ///< cuts of wasteful triangles' boxes beforehand, as a share of the triangles
};

/// Binned surface area heuristic: Wald (2007), "On fast Construction of SAH-based Bounding Volume
/// Hierarchies". The tree does not depend on the number of threads.
BinaryTree build_binary_tree(const MeshView& mesh, const BuildParameters& parameters);

/// Over any primitives, at least one.
BinaryTree build_binary_tree(std::vector<PrimRef> primitives, const BuildParameters& parameters);

}  // namespace castray
