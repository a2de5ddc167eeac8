#pragma once

#include <cstdint>
#include <vector>

namespace castray {

/// A box and what is in it: two children side by side in one pair (`count` 0), or a run of primitives.
struct BvhNode {
  float lower[3];
  std::uint32_t first;  ///< inner: the children's pair; leaf: position of its first primitive
  float upper[3];
  std::uint32_t count;  ///< primitives of a leaf; 0 says inner

  bool is_leaf() const { return count > 0; }
};

/// Siblings, together in one cache line.
struct alignas(64) BvhPair {
  BvhNode child[2];
};
static_assert(sizeof(BvhPair) == 64);

/// A binary tree over primitives 0 .. n-1: leaves hold runs of `primitives`, a permutation of them (some
/// several times, if the builder cut boxes).
struct BinaryTree {
  BvhNode root{};  ///< a leaf if all fit in one; meaningless without primitives
  std::vector<BvhPair> pairs;
  std::vector<std::uint32_t> primitives;
  int depth = 0;        ///< edges from the root to its deepest leaf
  double sah_cost = 0;  ///< expected node visits + primitive tests of a ray that meets the root's box
};

}  // namespace castray
