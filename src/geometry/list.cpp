#include "geometry/list.h"

#include <bit>

namespace castray {

TriangleList::TriangleList(const MeshView& mesh) : mesh_(mesh) {
  constexpr std::uint32_t n = 8;
  lanes_.resize((mesh.count + n - 1) / n);
  for (std::uint32_t i = 0; i < lanes_.size() * n; ++i)
    for (std::uint32_t k = 0; k < 3; ++k) {
      const Vec3f& p = mesh.positions[mesh.triangles[std::min(i, mesh.count - 1)][k]];
      for (int axis = 0; axis < 3; ++axis) lanes_[i / n].vertex[k][axis][i % n] = p[axis];
    }
}

template <bool any, class T>
Hit<T> TriangleList::search(const Ray<T>& ray, const HitFilter<T>& counts) const {
  Hit<T> hit;
  if (!is_traceable(ray)) return hit;
  const TriangleTest<T> test(ray);
  std::uint32_t first = 0;
  for (const TriangleLanes& lanes : lanes_) {
    for (unsigned left = test.candidates(lanes, std::min(ray.t_max, hit.t)); left != 0; left &= left - 1) {
      const std::uint32_t triangle = first + static_cast<std::uint32_t>(std::countr_zero(left));
      if (triangle < mesh_.count) intersect_triangle(test, mesh_, triangle, ray.t_max, counts, hit);
      if (any && hit.found()) return hit;
    }
    first += 8;
  }
  return hit;
}

template <bool any, class T>
[[gnu::target("avx2,fma"), gnu::flatten]] Hit<T> TriangleList::search_avx2(const Ray<T>& ray,
                                                                           const HitFilter<T>& counts) const {
  return search<any>(ray, counts);
}

template <bool any, class T>
Hit<T> TriangleList::dispatch(const Ray<T>& ray, const HitFilter<T>& counts) const {
  static const bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  return avx2 ? search_avx2<any>(ray, counts) : search<any>(ray, counts);
}

template <class T>
Hit<T> TriangleList::closest(const Ray<T>& ray, const HitFilter<T>& counts) const {
  return dispatch<false>(ray, counts);
}

template <class T>
bool TriangleList::occluded(const Ray<T>& ray, const HitFilter<T>& counts) const {
  return dispatch<true>(ray, counts).found();
}

template Hit<float> TriangleList::closest(const Ray<float>&, const HitFilter<float>&) const;
template Hit<double> TriangleList::closest(const Ray<double>&, const HitFilter<double>&) const;
template bool TriangleList::occluded(const Ray<float>&, const HitFilter<float>&) const;
template bool TriangleList::occluded(const Ray<double>&, const HitFilter<double>&) const;

}  // namespace castray
