#include "lights/light_share.h"

#include <algorithm>
#include <limits>
#include <numbers>

#include "core/triangle_corners.h"
#include "geometry/bounds.h"
#include "materials/surface_values.h"

namespace castray {

namespace {

/// Looking at more pairs of a light and a triangle would take long.
constexpr std::size_t most_pairs = 1u << 22;

bool all_diffuse(const Scene& scene) {
  const std::vector<bool> used = scene.used_materials();
  for (std::size_t i = 0; i < used.size(); ++i)
    if (used[i] && scene.materials[i].type != MaterialType::diffuse) return false;
  return true;
}

/// Whether the light shines on any corner of the triangle, walls between them left aside.
bool shines_on(const Scene& scene, std::uint32_t light, std::uint32_t triangle) {
  constexpr double in_plane = 0x1p-20;  // scenes are scaled to about 1
  const TriangleCorners lamp = corners_of(scene, light);
  const Vec3d normal = normalize(lamp.twice_area());
  const std::uint16_t material = scene.triangle_material[light];
  const bool front = scene.emits_on(material, true), back = scene.emits_on(material, false);
  return std::ranges::any_of(corners_of(scene, triangle).all(), [&](const Vec3d& corner) {
    const double above = dot(corner - lamp.a, normal);
    return (front && above > in_plane) || (back && above < -in_plane);
  });
}

/// Of the distance between two boxes.
double distance2(const Bounds& a, const Bounds& b) {
  const Vec3d gap(to_vec3(max(max(a.lower - b.upper, b.lower - a.upper), Float4(0.f))));
  return dot(gap, gap);
}

/// Whether the light shines on anything closer than that.
bool shines_within(const Scene& scene, std::uint32_t light, double squared_distance) {
  const MeshView mesh = mesh_of(scene);
  const Bounds bounds = triangle_bounds(mesh, light);
  for (std::uint32_t i = 0; i < scene.triangles.size(); ++i)
    if (distance2(bounds, triangle_bounds(mesh, i)) < squared_distance && shines_on(scene, light, i))
      return true;
  return false;
}

/// Whether BSDF sampling may be denser than light sampling somewhere. Per area of a light, at distance d, the
/// density of a diffuse surface's directions is at most 1 / (pi d^2).
bool bsdf_may_be_denser(const Scene& scene, double bsdf_samples) {
  if (scene.lights.empty()) return false;
  if (!scene.instances.empty()) return true;
  if (scene.lights.size() > most_pairs / scene.triangles.size() || !all_diffuse(scene)) return true;
  const std::vector<Vec3d> emission = mean_emissions(scene);
  double power = 0;
  for (const std::uint32_t light : scene.lights)
    for (const std::uint16_t side : scene.emitting_sides(scene.triangle_material[light])) {
      const int directions = scene.materials[side].two_sided_emission ? 2 : 1;
      power += luminance(emission[side]) * directions * length(corners_of(scene, light).twice_area()) / 2;
    }
  return std::ranges::any_of(scene.lights, [&](std::uint32_t light) {
    double density = std::numeric_limits<double>::infinity();
    for (const std::uint16_t side : scene.emitting_sides(scene.triangle_material[light]))
      density = std::min(density, luminance(emission[side]) / power);
    return shines_within(scene, light, bsdf_samples / (std::numbers::pi * density));
  });
}

}  // namespace

bool uses_mis(Switch mis, const Scene& scene, double bsdf_samples) {
  if (mis != Switch::automatic) return mis == Switch::on;
  return scene.environment_image.used() || bsdf_may_be_denser(scene, bsdf_samples);
}

}  // namespace castray
