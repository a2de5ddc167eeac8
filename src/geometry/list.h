#pragma once

#include <vector>

#include "geometry/triangle.h"

namespace castray {

/// Tests every triangle: for tiny scenes, and what every tree is tested against. The mesh must outlive it.
class TriangleList {
 public:
  explicit TriangleList(const MeshView& mesh);

  /// The nearest hit with 0 < t < t_max that counts; of equally near ones that of the lowest triangle.
  template <class T>
  Hit<T> closest(const Ray<T>& ray, const HitFilter<T>& counts = {}) const;

  /// Whether there is any hit with 0 < t < t_max that counts.
  template <class T>
  bool occluded(const Ray<T>& ray, const HitFilter<T>& counts = {}) const;

 private:
  template <bool any, class T>
  Hit<T> search(const Ray<T>& ray, const HitFilter<T>& counts) const;
  /// The same, compiled for processors of today.
  template <bool any, class T>
  Hit<T> search_avx2(const Ray<T>& ray, const HitFilter<T>& counts) const;
  template <bool any, class T>
  Hit<T> dispatch(const Ray<T>& ray, const HitFilter<T>& counts) const;

  MeshView mesh_;
  std::vector<TriangleLanes> lanes_;  ///< all of the mesh, the last ones repeated to fill up
};

}  // namespace castray
