#pragma once

#include <vector>

#include "accel/ray.h"
#include "integrate/wavefront.h"
#include "kernels/api.h"

namespace castray {

/// The kernels that this processor can run.
inline std::vector<const KernelApi*> available_kernels() {
  std::vector<const KernelApi*> kernels;
  for (const char* name : {"scalar", "sse4", "avx2", "avx512"}) {
    try {
      kernels.push_back(&choose_kernel(name));
    } catch (const InputError&) {
    }
  }
  return kernels;
}

/// Rays as kernels take them: each number of all rays side by side.
class RayArrays {
 public:
  explicit RayArrays(const std::vector<Ray<float>>& rays) {
    for (const Ray<float>& ray : rays) {
      for (int i = 0; i < 3; ++i) {
        number_[i].push_back(ray.origin[i]);
        number_[3 + i].push_back(ray.direction[i]);
      }
      number_[6].push_back(ray.t_max);
    }
  }

  std::vector<Hit<float>> closest(const KernelApi& kernel, const WideBvhView& bvh) const {
    const std::size_t n = number_[0].size();
    std::vector<float> t(n), b1(n), b2(n);
    std::vector<std::uint32_t> triangle(n);
    kernel.bvh_closest(bvh, {in(0), in(1), in(2), in(3), in(4), in(5), in(6), t.data(), triangle.data(),
                             b1.data(), b2.data(), static_cast<std::uint32_t>(n)});
    std::vector<Hit<float>> hits(n);
    for (std::size_t i = 0; i < n; ++i) hits[i] = {t[i], triangle[i], b1[i], b2[i]};
    return hits;
  }

  std::vector<std::uint8_t> occluded(const KernelApi& kernel, const WideBvhView& bvh) const {
    std::vector<std::uint8_t> result(number_[0].size());
    kernel.bvh_occluded(bvh, {in(0), in(1), in(2), in(3), in(4), in(5), in(6), result.data(),
                              static_cast<std::uint32_t>(result.size())});
    return result;
  }

 private:
  const float* in(int i) const { return number_[i].data(); }

  std::vector<float> number_[7];
};

}  // namespace castray
