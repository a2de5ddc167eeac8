#include "geometry/build_quality.h"

#include <algorithm>
#include <cmath>

#include "geometry/bounds.h"

namespace castray {

double wasted_boxes(const MeshView& mesh) {
  Bounds all;
  double wasted = 0;
  for (std::uint32_t i = 0; i < mesh.count; ++i) {
    const Bounds box = triangle_bounds(mesh, i);
    all.add(box);
    wasted += static_cast<double>(std::max(0.0f, half_area(box) - least_half_area(mesh, i)));
  }
  const auto whole = static_cast<double>(half_area(all));
  return mesh.count > 0 && whole > 0 ? wasted / whole : 0;
}

BuildQuality choose_build(BuildQuality asked, double wasted, std::uint32_t triangles, double rays) {
  constexpr double worth_cutting = 256, seconds_gained = 2e-9, seconds_to_cut = 1.6e-6;
  if (asked == BuildQuality::fast || wasted < worth_cutting) return BuildQuality::fast;
  const bool pays = rays * wasted * seconds_gained > triangles * seconds_to_cut;
  return asked == BuildQuality::best || pays ? BuildQuality::best : BuildQuality::fast;
}

const char* name_of(BuildQuality quality) {
  return quality == BuildQuality::best ? "best" : quality == BuildQuality::fast ? "fast" : "auto";
}

}  // namespace castray
