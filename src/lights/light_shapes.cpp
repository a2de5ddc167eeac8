#include "lights/light_shapes.h"

#include <algorithm>
#include <cmath>

#include "core/put.h"
#include "materials/surface_values.h"

namespace castray {

namespace {

/// A material that emits, and its mean emission.
struct Emitter {
  std::uint16_t number;
  const Material& material;
  Vec3d mean;
};

KernelLight facet_light(const Facet& f, const Emitter& emitter) {
  KernelLight light{};
  const Vec3d a{f.corner[0][0], f.corner[0][1], f.corner[0][2]},
      b{f.corner[1][0], f.corner[1][1], f.corner[1][2]};
  const Vec3d d{f.corner[3][0], f.corner[3][1], f.corner[3][2]};
  const Vec3d normal = cross(b - a, d - a);
  put(light.origin, a);
  put(light.edge1, b - a);
  put(light.edge2, d - a);
  put(light.normal, normalize(emitter.material.emits_backwards ? -normal : normal));
  put(light.emission, emitter.mean);
  light.material = emitter.number;
  light.source = f.triangle[0];
  light.area = static_cast<float>(length(normal));
  light.two_sided = emitter.material.two_sided_emission;
  light.rectangle = std::abs(dot(b - a, d - a)) <= 1e-6 * length(b - a) * length(d - a);
  light.error = f.error;
  light.step = 1;
  return light;
}

KernelLight triangle_light(const Facet& f, int first, const Emitter& emitter) {
  Facet triangle = f;  // corners first, first + 1, first + 2
  std::copy_n(f.corner[first], 3, triangle.corner[0]);
  std::copy_n(f.corner[(first + 1) % 4], 3, triangle.corner[1]);
  std::copy_n(f.corner[(first + 2) % 4], 3, triangle.corner[3]);
  KernelLight light = facet_light(triangle, emitter);
  light.area /= 2;
  light.triangle = 1;
  light.rectangle = 0;
  return light;
}

/// A part of a triangle, or all of it.
KernelLight part_of(const KernelLight& whole, const EmissionCell& cell) {
  constexpr float rounding = 0x1p-22f;  // of its corners, which are in [-1,1]
  KernelLight part = whole;
  put(part.emission, cell.emission);
  if (cell.step == 1) return part;
  for (int c = 0; c < 3; ++c) {
    part.origin[c] =
        static_cast<float>(whole.origin[c] + cell.b1 * whole.edge1[c] + cell.b2 * whole.edge2[c]);
    part.edge1[c] = static_cast<float>(cell.step * whole.edge1[c]);
    part.edge2[c] = static_cast<float>(cell.step * whole.edge2[c]);
  }
  part.area = static_cast<float>(cell.step * cell.step * whole.area);
  part.corner[0] = static_cast<float>(cell.b1);
  part.corner[1] = static_cast<float>(cell.b2);
  part.step = static_cast<float>(cell.step);
  part.error = whole.error + rounding;
  return part;
}

bool is_parallelogram(const Facet& f) {
  double size = 0, gap = 0;
  for (int c = 0; c < 3; ++c) {
    size = std::max<double>(size, std::abs(f.corner[2][c] - f.corner[0][c]));
    gap = std::max(gap, std::abs(double{f.corner[0][c]} + f.corner[2][c] - f.corner[1][c] - f.corner[3][c]));
  }
  return gap <= 1e-6 * size;
}

void add_shapes(const Facet& f, const Emitter& emitter, const EmissionCells& cells,
                std::vector<KernelLight>& lights) {
  if (f.triangle[0] == f.triangle[1]) {
    const KernelLight whole = triangle_light(f, 0, emitter);
    for (const EmissionCell& cell : cells.of(f.triangle[0], emitter.number))
      lights.push_back(part_of(whole, cell));
  } else if (is_parallelogram(f)) {
    lights.push_back(facet_light(f, emitter));
  } else {
    lights.push_back(triangle_light(f, 0, emitter));
    lights.push_back(triangle_light(f, 2, emitter));
  }
}

}  // namespace

std::vector<KernelLight> light_shapes(const std::vector<Facet>& facets, const Scene& scene,
                                      const EmissionCells& cells) {
  const std::vector<Vec3d> mean = mean_emissions(scene);
  std::vector<KernelLight> lights;
  for (const Facet& f : facets)
    for (const std::uint16_t side : scene.emitting_sides(static_cast<std::uint16_t>(f.material)))
      add_shapes(f, {side, scene.materials[side], mean[side]}, cells, lights);
  return lights;
}

}  // namespace castray
