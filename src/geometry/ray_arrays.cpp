#include "geometry/ray_arrays.h"

#include <algorithm>

namespace castray {

constexpr std::size_t batch_of_rays = 512;

void RayArrays::closest(const std::function<void(const RayBatch&)>& trace, std::size_t first,
                        std::size_t count, Hit<float>* hits) const {
  for (std::size_t done = 0; done < count; done += batch_of_rays) {
    const auto n = static_cast<std::uint32_t>(std::min(batch_of_rays, count - done));
    const auto in = [&](int i) { return number_[i].data() + first + done; };
    float t[batch_of_rays], b1[batch_of_rays], b2[batch_of_rays];
    std::uint32_t triangle[batch_of_rays], instance[batch_of_rays];
    std::fill_n(instance, n, Scene::no_index);
    trace({in(0), in(1), in(2), in(3), in(4), in(5), in(6), t, triangle, b1, b2, n, instance});
    for (std::uint32_t i = 0; i < n; ++i) hits[done + i] = {t[i], triangle[i], b1[i], b2[i], instance[i]};
  }
}

void RayArrays::occluded(const std::function<void(const ShadowBatch&)>& trace, std::size_t first,
                         std::size_t count, std::uint8_t* occluded) const {
  for (std::size_t done = 0; done < count; done += batch_of_rays) {
    const auto n = static_cast<std::uint32_t>(std::min(batch_of_rays, count - done));
    const auto in = [&](int i) { return number_[i].data() + first + done; };
    trace({in(0), in(1), in(2), in(3), in(4), in(5), in(6), occluded + done, n});
  }
}

}  // namespace castray
