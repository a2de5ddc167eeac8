#include "lights/emission_cells.h"

#include <algorithm>
#include <cmath>

#include "materials/surface_values.h"

namespace castray {

namespace {

/// As many cells, and looks at images, as take a twentieth of a second.
constexpr double most_cells = 1 << 12, most_looks = 1 << 17;
constexpr int most_steps = 32, most_looks_along = 8;
constexpr double by_mean = 0.125;

Vec3d emission_at(const Scene& scene, std::uint32_t triangle, double b1, double b2) {
  const auto values =
      surface_values(scene, scene.material_of(triangle), TrianglePlace<double>{triangle, b1, b2});
  return values.color(slot_emission) * values.at(slot_coverage);
}

/// Calls `visit` with b1, b2 and the step of each of the steps^2 parts of a triangle.
template <class Visit>
void for_each_part(int steps, Visit visit) {
  const double step = 1. / steps;
  for (int i = 0; i < steps; ++i)
    for (int j = 0; i + j < steps; ++j) {
      visit(i * step, j * step, step);
      if (i + j + 1 < steps) visit((i + 1) * step, (j + 1) * step, -step);
    }
}

int root(double x, int most) { return std::clamp(static_cast<int>(std::sqrt(x)), 1, most); }

}  // namespace

EmissionCells::EmissionCells(const Scene& scene) : scene_(&scene), means_(mean_emissions(scene)) {
  const auto is_varied = [&](std::uint32_t t) {
    const std::uint16_t material = scene.triangle_material[t];
    return scene.materials[material].has_emission_map() && scene.emitting_sides(material).size() == 1 &&
           scene.triangle_uvs[t][0] != Scene::no_index;
  };
  if (scene.triangle_uvs.empty()) return;
  const auto varied = static_cast<double>(std::ranges::count_if(scene.lights, is_varied));
  if (varied == 0) return;
  steps_ = root(most_cells / varied, most_steps);
  const int looks = root(most_looks / (varied * steps_ * steps_), most_looks_along);
  first_.assign(scene.triangles.size(), no_cells);  // those of instances are hit, too
  for (const std::uint32_t triangle : scene.lights)
    if (is_varied(triangle)) add(scene, triangle, looks);
}

void EmissionCells::add(const Scene& scene, std::uint32_t triangle, int looks) {
  const Vec3d mean = means_[scene.triangle_material[triangle]];
  first_[triangle] = static_cast<std::uint32_t>(emission_.size());
  emission_.resize(emission_.size() + static_cast<std::size_t>(2 * steps_ * steps_));
  for_each_part(steps_, [&](double b1, double b2, double step) {
    Vec3d sum;
    for_each_part(looks, [&](double part1, double part2, double part) {
      const double x = b1 + step * (part1 + part / 3), y = b2 + step * (part2 + part / 3);
      sum += emission_at(scene, triangle, x, y) / (looks * looks);
    });
    const Vec3d emission = sum * (1 - by_mean) + mean * by_mean;
    const std::size_t place = cell_at(b1 + step / 3, b2 + step / 3);
    emission_[first_[triangle] + place] = emission;
    // The upper half of a square across the longest edge is no part, but for rounding.
    if (step > 0) emission_[first_[triangle] + (place | 1)] = emission;
  });
  for (std::size_t i = shares_.size(); i < emission_.size(); ++i)
    shares_.push_back(static_cast<float>(luminance(emission_[i]) / luminance(mean)));
}

std::size_t EmissionCells::cell_at(double b1, double b2) const {
  const double x = b1 * steps_, y = b2 * steps_;
  const int i = std::clamp(static_cast<int>(x), 0, steps_ - 1);
  const int j = std::clamp(static_cast<int>(y), 0, steps_ - 1 - i);
  return static_cast<std::size_t>(2 * (i * steps_ + j) + ((x - i) + (y - j) > 1 ? 1 : 0));
}

std::vector<EmissionCell> EmissionCells::of(std::uint32_t triangle, std::uint16_t material) const {
  if (!has_cells(triangle)) return {{.emission = means_[material]}};
  std::vector<EmissionCell> cells;
  for_each_part(steps_, [&](double b1, double b2, double step) {
    const std::size_t place = cell_at(b1 + step / 3, b2 + step / 3);
    cells.push_back({b1, b2, step, emission_[first_[triangle] + place]});
  });
  return cells;
}

double EmissionCells::share(std::uint32_t triangle, double b1, double b2) const {
  return has_cells(triangle) ? double{shares_[first_[triangle] + cell_at(b1, b2)]} : 1;
}

CellTable EmissionCells::table() const {
  if (first_.empty()) return {};
  return {first_.data(), shares_.data(), static_cast<float>(steps_)};
}

}  // namespace castray
