#include "lights/area_lights.h"

#include <algorithm>

#include "core/error_bounds.h"
#include "core/triangle_corners.h"
#include "materials/surface_values.h"

namespace castray {

template <class T>
AreaLights<T>::AreaLights(const Scene& scene)
    : scene_(scene), cells_(scene), material_density_(scene.materials.size()) {
  double power = 0;
  std::vector<double> powers;
  for (const std::uint32_t i : scene.lights) {
    const TriangleCorners c = corners_of(scene, i);
    const Vec3d normal = c.twice_area();
    for (const std::uint16_t side : scene.emitting_sides(scene.triangle_material[i])) {
      const Material& material = scene.materials[side];
      const Vec3d outward = normalize(material.emits_backwards ? -normal : normal);
      for (const EmissionCell& cell : cells_.of(i, side)) {
        powers.push_back(length(normal) / 2 * cell.step * cell.step * luminance(cell.emission));
        power += powers.back();
        cumulative_.push_back(power);
        triangles_.push_back({Vec3<T>(c.a), Vec3<T>(c.b), Vec3<T>(c.c), Vec3<T>(outward),
                              Vec3<T>(material.ke * material.coverage), side, T(0),
                              TrianglePlace<T>{i, T(cell.b1), T(cell.b2)}, T(cell.step),
                              material.two_sided_emission});
      }
    }
  }
  for (double& c : cumulative_) c /= power;
  const std::vector<Vec3d> mean = mean_emissions(scene);
  for (std::size_t m = 0; m < scene.materials.size(); ++m)
    material_density_[m] = power > 0 ? static_cast<T>(luminance(mean[m]) / power) : T(0);
  for (std::size_t i = 0; i < triangles_.size(); ++i)
    triangles_[i].choice = static_cast<T>(powers[i] / power);
}

template <class T>
LightPoint<T> AreaLights<T>::sample(double u_choice, Point2<T> u) const {
  const auto found = std::upper_bound(cumulative_.begin(), cumulative_.end() - 1, u_choice);
  const Triangle& t = triangles_[static_cast<std::size_t>(found - cumulative_.begin())];
  TrianglePlace<T> place = t.corner;
  const auto [b1, b2] = uniform_triangle(u);
  place.b1 += t.step * b1;
  place.b2 += t.step * b2;
  const TrianglePoint<T> point = point_on_triangle(t.v0, t.v1, t.v2, place.b1, place.b2);
  Vec3<T> radiance = t.radiance;
  if (const Material& m = scene_.materials[t.material]; m.has_emission_map()) {
    const SurfaceValues<T> values = surface_values(scene_, m, place);
    radiance = values.color(slot_emission) * values.at(slot_coverage);
  }
  return {point.p,  point.error,    t.normal,   radiance, pdf_area(t.material, place),
          t.choice, place.triangle, t.two_sided};
}

template class AreaLights<float>;
template class AreaLights<double>;

}  // namespace castray
