#include "geometry/bvh.h"

#include <fmt/format.h>

#include <chrono>

#include "geometry/bvh_build.h"
#include "geometry/triangle.h"
#include "geometry/visit_leaves.h"

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
  const TriangleTest<T> test(ray);
  visit_leaves(tree_, slab_test(ray, test.main_axis(), tree_), ray.t_max, [&](const BvhNode& leaf) {
    for (std::uint32_t i = 0; i < leaf.count; ++i) {
      intersect_triangle(test, mesh_, tree_.primitives[leaf.first + i], ray.t_max, counts, hit);
      if (any && hit.found()) return T(-1);
    }
    return hit.found() ? hit.t : ray.t_max;
  });
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
