#pragma once

#include <catch2/catch.hpp>

#include <map>

#include "integrators.h"

namespace castray::test {

/// That instruction sets of one arithmetic give the same bytes, over list and tree, with shared and plain
/// paths: what is true of the means of one of them is true of the others'. Two samples a pixel.
inline void check_same_bytes(const Scene& scene, RenderOptions options) {
  options.spp = 2;
  std::map<std::string, std::vector<Vec3f>> firsts;
  for (const Way& way : every_way(options)) {
    const RenderOptions& o = way.options;
    if (o.integrator == Integrator::reference) continue;
    const std::string alike = (has_fma(o.isa) ? "fused" : "not fused") + way.name.substr(o.isa.size());
    const std::vector<Vec3f> pixels = render(scene, o).film.image().pixels;
    CAPTURE(way.name);
    CHECK(firsts.try_emplace(alike, pixels).first->second == pixels);
  }
}

}  // namespace castray::test
