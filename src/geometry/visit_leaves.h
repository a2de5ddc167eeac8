#pragma once

#include "geometry/bvh_build.h"
#include "geometry/bvh_node.h"
#include "geometry/slab.h"

namespace castray {

/// Visits the leaves of a tree of at least one primitive that a ray meets before `nearest`, mostly the nearer
/// ones first. `visit`, given a leaf, returns `nearest` for those to come; below 0, none is visited any more.
template <class T, class Visit>
void visit_leaves(const BinaryTree& tree, const SlabTest<T>& slab, T nearest, const Visit& visit) {
  const BvhNode& root = tree.root;
  const auto enters = [&](const BvhNode& node, T& t) {
    return slab.intersect(node.lower, node.upper, nearest, t);
  };

  // What is still to be visited: at most one sibling for each level above the current node.
  struct Entry {
    const BvhNode* node;
    T t;
  };
  Entry stack[max_bvh_depth];
  Entry* top = stack;

  T t_root;
  const BvhNode* node = enters(root, t_root) ? &root : nullptr;
  while (node) {
    if (node->is_leaf()) {
      nearest = visit(*node);
      node = nullptr;
    } else {
      const BvhPair& pair = tree.pairs[node->first];
      T t0, t1;
      const bool in0 = enters(pair.child[0], t0), in1 = enters(pair.child[1], t1);
      const int first = in0 && !(in1 && t1 < t0) ? 0 : 1;
      node = in0 || in1 ? &pair.child[first] : nullptr;
      if (in0 && in1) *top++ = {&pair.child[1 - first], first == 0 ? t1 : t0};
    }
    while (!node && top != stack) {
      --top;
      if (top->t <= nearest) node = top->node;
    }
  }
}

/// A ray prepared for a tree's boxes.
template <class T>
SlabTest<T> slab_test(const Ray<T>& ray, int main_axis, const BinaryTree& tree) {
  const BvhNode& root = tree.root;
  return {ray, main_axis, Vec3f{root.lower[0], root.lower[1], root.lower[2]},
          Vec3f{root.upper[0], root.upper[1], root.upper[2]}};
}

}  // namespace castray
