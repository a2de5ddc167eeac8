#pragma once

#include "geometry/block_array.h"
#include "geometry/bvh_node.h"
#include "geometry/ray.h"
#include "geometry/wide_bvh_view.h"

namespace castray {

struct WideTree {
  BlockArray blocks;  ///< as WideBvhView describes them
  std::uint32_t nodes = 0;
  std::uint32_t root = 0;
  int depth = 0;
};

/// Makes nodes of eight children out of a binary tree, by opening the largest child again and again, and
/// packets out of its leaves. Leaves must hold at most packet_size * max_leaf_packets triangles.
WideTree collapse(const BinaryTree& tree, const MeshView& mesh, int threads);

/// The same without packets, of a tree with one primitive in each leaf: a leaf is child_unit times its
/// number, plus leaf_flag.
WideTree collapse_singles(const BinaryTree& tree, int threads);

}  // namespace castray
