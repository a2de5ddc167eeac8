#pragma once

#include <functional>
#include <vector>

#include "geometry/ray.h"
#include "geometry/ray_batches.h"

namespace castray {

/// Rays as kernels take them: each number of all rays side by side.
class RayArrays {
 public:
  RayArrays() = default;
  /// So many, to be set.
  explicit RayArrays(std::size_t count) {
    for (auto& numbers : number_) numbers.resize(count);
  }
  explicit RayArrays(const std::vector<Ray<float>>& rays) {
    for (const Ray<float>& ray : rays) add(ray);
  }

  void add(const Ray<float>& ray) {
    for (int i = 0; i < 3; ++i) {
      number_[i].push_back(ray.origin[i]);
      number_[3 + i].push_back(ray.direction[i]);
    }
    number_[6].push_back(ray.t_max);
  }

  void set(std::size_t at, const Ray<float>& ray) {
    for (int i = 0; i < 3; ++i) {
      number_[i][at] = ray.origin[i];
      number_[3 + i][at] = ray.direction[i];
    }
    number_[6][at] = ray.t_max;
  }

  std::size_t size() const { return number_[6].size(); }

  Ray<float> operator[](std::size_t i) const {
    const auto& n = number_;
    return {{n[0][i], n[1][i], n[2][i]}, {n[3][i], n[4][i], n[5][i]}, n[6][i]};
  }

  /// The nearest hits of rays [first, first + count), as `trace` finds them, into `hits` from 0 on.
  void closest(const std::function<void(const RayBatch&)>& trace, std::size_t first, std::size_t count,
               Hit<float>* hits) const;

  /// Whether they hit anything, 1 or 0.
  void occluded(const std::function<void(const ShadowBatch&)>& trace, std::size_t first, std::size_t count,
                std::uint8_t* occluded) const;

 private:
  std::vector<float> number_[7];
};

}  // namespace castray
