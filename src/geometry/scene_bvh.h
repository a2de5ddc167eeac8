#pragma once

#include <vector>

#include "geometry/bvh.h"
#include "geometry/placement.h"

namespace castray {

/// All of a scene as binary trees: one over the triangles in scene space, one over those of each shared mesh,
/// and one over the boxes of instances. The scene must outlive it.
///
/// A ray goes on in the space of an instance's mesh in double, as o' + t d' with the same t. Hits in scene
/// space have no instance.
class SceneBvh {
 public:
  /// The trees do not depend on `threads`.
  static SceneBvh build(const Scene& scene, int threads);

  /// The nearest hit with 0 < t < t_max that counts.
  template <class T>
  Hit<T> closest(const Ray<T>& ray, const HitFilter<T>& counts = {}) const;

  /// Whether there is any hit with 0 < t < t_max that counts.
  template <class T>
  bool occluded(const Ray<T>& ray, const HitFilter<T>& counts = {}) const;

  /// Triangles, nodes and bytes of all trees together.
  const BvhStats& stats() const { return stats_; }

 private:
  struct Instance {
    Placed place;
    std::uint32_t mesh;
  };
  struct Mesh {
    Bvh bvh;
    std::uint32_t first;  ///< triangle
  };
  template <bool any, class T>
  Hit<T> search_instances(const Ray<T>& ray, const HitFilter<T>& counts, const Hit<T>& so_far) const;

  explicit SceneBvh(Bvh own) : own_(std::move(own)), stats_(own_.stats()) {}
  void build_top(const Scene& scene, int threads);

  Bvh own_;
  std::vector<Mesh> meshes_;
  std::vector<Instance> instances_;
  BinaryTree top_;
  BvhStats stats_;
};

}  // namespace castray
