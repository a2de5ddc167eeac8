#include <algorithm>

#include "castray/scene.h"

namespace castray {

std::size_t Scene::object_of(std::uint32_t triangle) const {
  const auto next = std::ranges::upper_bound(objects, triangle, {}, &SceneObject::first_triangle);
  return static_cast<std::size_t>(next - objects.begin()) - 1;
}

}  // namespace castray
