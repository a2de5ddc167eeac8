#include "lights/covered_lights.h"

#include <algorithm>

namespace castray {

namespace {

/// More than error_of_test of the longest segment, along a normal: 24u times 2 sqrt(3), and a light point's
/// own error.
constexpr float reach = 0x1p-16f;
constexpr std::size_t most_pairs = 1u << 22;

using Corners = Vec3f[3];

/// Whether part of the triangle is within reach of the light's plane, on a side that shines.
bool is_near_plane(const Corners& triangle, const Facet& light, bool front, bool back) {
  constexpr float in_plane = 0x1p-22f;  // the light's other triangle, and what lies beside it
  float lowest = reach, highest = -reach;
  for (const Vec3f& p : triangle) {
    const float above = dot(Vec3f(light.normal[0], light.normal[1], light.normal[2]), p) - light.offset;
    lowest = std::min(lowest, above);
    highest = std::max(highest, above);
  }
  return (front && lowest < reach && highest > in_plane) || (back && highest > -reach && lowest < -in_plane);
}

bool overlaps(const Corners& triangle, const Facet& light) {
  for (int axis = 0; axis < 3; ++axis) {
    float low = triangle[0][axis], high = low, light_low = light.corner[0][axis], light_high = light_low;
    for (const Vec3f& p : triangle) {
      low = std::min(low, p[axis]);
      high = std::max(high, p[axis]);
    }
    for (const auto& c : light.corner) {
      light_low = std::min(light_low, c[axis]);
      light_high = std::max(light_high, c[axis]);
    }
    if (low > light_high + reach || high < light_low - reach) return false;
  }
  return true;
}

bool share_a_corner(const Corners& triangle, const Facet& light) {
  return std::ranges::any_of(triangle, [&](const Vec3f& p) {
    return std::ranges::any_of(light.corner, [&](const auto& c) { return p == Vec3f(c[0], c[1], c[2]); });
  });
}

}  // namespace

bool may_be_covered(const Scene& scene, const std::vector<Facet>& lights) {
  if (!scene.instances.empty() || lights.size() > most_pairs / scene.triangles.size()) return true;
  return std::ranges::any_of(lights, [&](const Facet& light) {
    const auto material = static_cast<std::uint16_t>(light.material);
    const bool front = scene.emits_on(material, true), back = scene.emits_on(material, false);
    return std::ranges::any_of(scene.triangles, [&](const Index3& t) {
      const Corners triangle = {scene.positions[t[0]], scene.positions[t[1]], scene.positions[t[2]]};
      return is_near_plane(triangle, light, front, back) && overlaps(triangle, light) &&
             !share_a_corner(triangle, light);
    });
  });
}

}  // namespace castray
