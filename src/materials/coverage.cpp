#include "materials/coverage.h"

#include <algorithm>

#include "core/contract.h"
#include "materials/surface_values.h"

namespace castray {

Coverage::Coverage(const Scene& scene) : scene_(scene) {
  if (std::ranges::none_of(scene.materials, &Material::may_have_holes)) return;
  partial_.resize((scene.triangles.size() + 31) / 32);
  for (std::uint32_t i = 0; i < scene.triangles.size(); ++i)
    if (scene.material_of(i).may_have_holes()) partial_[i / 32] |= 1u << (i % 32);
}

template <class T>
bool Coverage::is_there(std::uint32_t world, std::uint32_t triangle, T b1, T b2) const {
  const T coverage = coverage_at(scene_, TrianglePlace<T>{triangle, b1, b2});
  if (coverage >= 1) return true;
  if (!(coverage > 0)) return false;
  return presence_number(world, triangle, static_cast<float>(b1), static_cast<float>(b2)) < coverage;
}

float Coverage::share_there(std::uint32_t triangle, float b1, float b2) const {
  return coverage_at(scene_, TrianglePlace<float>{triangle, b1, b2});
}

template <class T>
HitFilter<T> Coverage::there_in(std::uint32_t world) const {
  if (partial_.empty()) return {};
  return [this, world](const Hit<T>& hit) {
    if (!is_partial(hit.triangle)) return true;
    const bool in_scene = hit.instance == Scene::no_index;
    return is_there(in_scene ? world : hash_combine(world, hit.instance), hit.triangle, hit.b1, hit.b2);
  };
}

template bool Coverage::is_there(std::uint32_t, std::uint32_t, float, float) const;
template bool Coverage::is_there(std::uint32_t, std::uint32_t, double, double) const;
template HitFilter<float> Coverage::there_in(std::uint32_t) const;
template HitFilter<double> Coverage::there_in(std::uint32_t) const;

}  // namespace castray
