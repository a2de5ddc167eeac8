#include "geometry/wide_bvh.h"

#include <algorithm>
#include <chrono>

#include "geometry/bvh_build.h"
#include "geometry/collapse.h"
#include "geometry/node_normals.h"

namespace castray {

WideBvh WideBvh::build(const MeshView& mesh, int threads, BuildQuality quality,
                       const ClosedSurface* surface) {
  const auto start = std::chrono::steady_clock::now();
  WideBvh bvh;
  if (mesh.count > 0) {
    const BuildParameters parameters{.threads = threads,
                                     .max_leaf = packet_size,
                                     .leaf_block_log2 = 3,
                                     .traversal_cost = 0.5f,
                                     .split_share = quality == BuildQuality::best ? 2.0 : 0.0};
    const BinaryTree tree = build_binary_tree(mesh, parameters);
    WideTree wide = collapse(tree, mesh, threads);
    if (surface) bound_normals(wide, *surface, threads);
    bvh.blocks_ = std::move(wide.blocks);
    bvh.view_.root = wide.root;
    bvh.view_.depth = wide.depth;
    std::copy_n(tree.root.lower, 3, bvh.view_.lower);
    std::copy_n(tree.root.upper, 3, bvh.view_.upper);
    bvh.stats_.sah_cost = tree.sah_cost;
    bvh.stats_.depth = wide.depth;
    bvh.stats_.nodes = wide.nodes;
  }
  bvh.view_.blocks = bvh.blocks_.data();
  bvh.view_.triangles = mesh.count;
  bvh.stats_.triangles = mesh.count;
  bvh.stats_.bytes = bvh.blocks_.bytes();
  bvh.stats_.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return bvh;
}

}  // namespace castray
