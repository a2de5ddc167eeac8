#include "lights/light_table.h"

#include <algorithm>
#include <cmath>

#include "lights/light_shapes.h"

namespace castray {

namespace {

/// Position of a light along a Morton curve through [-1,1]^3: stratified choices among lights in this
/// order are stratified in space.
std::uint64_t place_on_curve(const KernelLight& l) {
  std::uint64_t place = 0;
  for (int c = 0; c < 3; ++c) {
    const double middle = l.origin[c] + (l.edge1[c] + l.edge2[c]) / (l.triangle ? 3.0 : 2.0);
    const auto cell = static_cast<std::uint64_t>(std::clamp((middle + 1) * 0x1p19, 0.0, 0x1p20 - 1));
    for (int bit = 0; bit < 20; ++bit) place |= ((cell >> bit) & 1u) << (3 * bit + c);
  }
  return place;
}

double radiance_of(const KernelLight& l) {
  return luminance(Vec3d(l.emission[0], l.emission[1], l.emission[2])) * (l.two_sided ? 2 : 1);
}

/// Sorts lights along the curve and sets their probabilities by power. Returns the total power over pi.
double sort_and_weigh(std::vector<KernelLight>& lights) {
  std::stable_sort(lights.begin(), lights.end(),
                   [](auto& a, auto& b) { return place_on_curve(a) < place_on_curve(b); });
  double total = 0, sum = 0;
  for (const KernelLight& l : lights) total += double{l.area} * radiance_of(l);
  for (KernelLight& l : lights) {
    l.cumulative = static_cast<float>(sum / total);
    l.density = static_cast<float>(radiance_of(l) / total);
    sum += double{l.area} * radiance_of(l);
  }
  for (std::size_t i = 0; i < lights.size(); ++i)  // what the search in the cumulative table really gives
    lights[i].probability = (i + 1 < lights.size() ? lights[i + 1].cumulative : 1.f) - lights[i].cumulative;
  return total;
}

}  // namespace

LightTable::LightTable(const Scene& scene, const std::vector<Facet>& facets, bool by_importance, int threads)
    : cells_(scene), lights_(light_shapes(facets, scene, cells_)), power_(sort_and_weigh(lights_)) {
  if (by_importance && lights_.size() > 1) tree_ = LightTree(lights_, threads);
}

LightList LightTable::list() const {
  LightList list{};
  list.lights = lights_.data();
  list.count = static_cast<std::uint32_t>(lights_.size());
  list.cut = tree_.cut().data();
  list.cut_count = static_cast<std::uint32_t>(tree_.cut().size());
  list.tree = tree_.pairs().data();
  list.cells = cells_.table();
  if (regions_) {
    list.regions = regions_->view();
    list.regions.node_of_primitive = node_of_primitive_.data();
  }
  return list;
}

std::uint32_t LightTable::first_of(std::size_t node) const {
  if (node == nodes()) return static_cast<std::uint32_t>(lights_.size());
  std::uint32_t next = tree_.cut()[node].next;
  while (next < light_leaf) next = tree_.pairs()[2 * next].next;
  return next - light_leaf;
}

std::vector<double> LightTable::power_shares() const {
  std::vector<double> shares;
  for (std::size_t node = 0; node < nodes(); ++node) {
    double power = 0;
    for (std::uint32_t i = first_of(node); i < first_of(node + 1); ++i)
      power += double{lights_[i].area} * radiance_of(lights_[i]);
    shares.push_back(power / power_);
  }
  return shares;
}

/// A facet that is no parallelogram is two lights. Both strategies of MIS must take it for the same node.
void LightTable::use(LightRegionTable regions, const std::vector<Facet>& facets, bool list,
                     std::size_t triangles) {
  std::vector<std::uint32_t> node_of_source(triangles, 0);
  for (std::size_t node = nodes(); node-- > 0;)
    for (std::uint32_t i = first_of(node); i < first_of(node + 1); ++i)
      node_of_source[lights_[i].source] = static_cast<std::uint32_t>(node);
  for (KernelLight& l : lights_) l.node = node_of_source[l.source];
  node_of_primitive_.assign(list ? facets.size() : triangles, 0);
  for (std::size_t i = 0; i < facets.size(); ++i) {
    const std::uint32_t node = node_of_source[facets[i].triangle[0]];
    if (list)
      node_of_primitive_[i] = node;
    else
      for (const std::uint32_t triangle : facets[i].triangle) node_of_primitive_[triangle] = node;
  }
  regions_ = std::move(regions);
}

float LightTable::density(const Material& material, const Vec3d& mean_emission) const {
  if (!material.emits()) return 0;
  return static_cast<float>(luminance(mean_emission) * (material.two_sided_emission ? 2 : 1) / power_);
}

}  // namespace castray
