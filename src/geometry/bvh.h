#pragma once

#include <cstdint>
#include <string>

#include "geometry/bvh_node.h"
#include "geometry/ray.h"

namespace castray {

/// What was built, and in how long.
struct BvhStats {
  std::uint32_t triangles = 0;
  std::uint32_t nodes = 0;  ///< inner nodes and leaves
  int depth = 0;            ///< edges from the root to its deepest leaf
  double sah_cost = 0;      ///< expected node visits + triangle tests of a ray that meets the root's box
  std::uint64_t bytes = 0;  ///< held by the tree; the mesh itself is borrowed
  double seconds = 0;
};
/// "BVH: 32 triangles, 19 nodes, depth 5, ..."
std::string to_string(const BvhStats& stats);

/// A binary bounding volume hierarchy over a mesh that must outlive it. Never changes once built. Its answers
/// are those of TriangleList, bit for bit.
class Bvh {
 public:
  /// Any mesh of finite coordinates will do, an empty one included. The tree does not depend on `threads`.
  static Bvh build(const MeshView& mesh, int threads);

  /// The nearest hit with 0 < t < t_max that counts; of equally near ones that of the lowest triangle.
  template <class T>
  Hit<T> closest(const Ray<T>& ray, const HitFilter<T>& counts = {}) const;

  /// Whether there is any hit with 0 < t < t_max that counts.
  template <class T>
  bool occluded(const Ray<T>& ray, const HitFilter<T>& counts = {}) const;

  const BvhStats& stats() const { return stats_; }

 private:
  template <bool any, class T>
  Hit<T> traverse(const Ray<T>& ray, const HitFilter<T>& counts) const;

  MeshView mesh_;
  BinaryTree tree_;
  BvhStats stats_;
};

}  // namespace castray
