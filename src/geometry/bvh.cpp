#include "geometry/bvh.h"

#include <fmt/format.h>

#include <chrono>

#include "geometry/bvh_build.h"
#include "geometry/slab.h"
#include "geometry/triangle.h"

namespace castray {

std::string to_string(const BvhStats& b) {
  return fmt::format("BVH: {} triangles, {} nodes, depth {}, SAH cost {:.1f}, {} bytes, {:.3f} s",
                     b.triangles, b.nodes, b.depth, b.sah_cost, b.bytes, b.seconds);
}

Bvh Bvh::build(const MeshView& mesh, int threads) {
  const auto start = std::chrono::steady_clock::now();
  Bvh bvh;
  bvh.mesh_ = mesh;
  bvh.tree_ = build_binary_tree(mesh, {.threads = threads});
  const BinaryTree& tree = bvh.tree_;
  bvh.stats_ = {.triangles = mesh.count,
                .nodes = static_cast<std::uint32_t>(mesh.count == 0 ? 0 : 2 * tree.pairs.size() + 1),
                .depth = tree.depth,
                .sah_cost = tree.sah_cost,
                .bytes = sizeof(Bvh) + tree.pairs.size() * sizeof(BvhPair) +
                         tree.primitives.size() * sizeof(std::uint32_t),
                .seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count()};
  return bvh;
}

template <bool any, class T>
Hit<T> Bvh::traverse(const Ray<T>& ray, const HitFilter<T>& counts) const {
  Hit<T> hit;
  if (mesh_.count == 0 || !is_traceable(ray)) return hit;
  const BvhNode& root = tree_.root;
  const TriangleTest<T> test(ray);
  const SlabTest<T> slab(ray, test.main_axis(), {root.lower[0], root.lower[1], root.lower[2]},
                         {root.upper[0], root.upper[1], root.upper[2]});
  T nearest = ray.t_max;
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
      for (std::uint32_t i = 0; i < node->count; ++i) {
        intersect_triangle(test, mesh_, tree_.primitives[node->first + i], ray.t_max, counts, hit);
        if (any && hit.found()) return hit;
      }
      if (hit.found()) nearest = hit.t;
      node = nullptr;
    } else {
      const BvhPair& pair = tree_.pairs[node->first];
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
  return hit;
}

template <class T>
Hit<T> Bvh::closest(const Ray<T>& ray, const HitFilter<T>& counts) const {
  return traverse<false>(ray, counts);
}

template <class T>
bool Bvh::occluded(const Ray<T>& ray, const HitFilter<T>& counts) const {
  return traverse<true>(ray, counts).found();
}

template Hit<float> Bvh::closest(const Ray<float>&, const HitFilter<float>&) const;
template Hit<double> Bvh::closest(const Ray<double>&, const HitFilter<double>&) const;
template bool Bvh::occluded(const Ray<float>&, const HitFilter<float>&) const;
template bool Bvh::occluded(const Ray<double>&, const HitFilter<double>&) const;

}  // namespace castray
