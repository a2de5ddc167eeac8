#include "wavefront/pilot_branches.h"

#include <catch2/catch.hpp>

#include <cmath>

#include "plan/plan.h"
#include "pretended_renders.h"

using namespace castray;
using namespace castray::test;

namespace {

/// Of one branch's noise the variance is `own`, beside `alike`, which any number of branches leaves.
RenderJob branching(double alike, double own, std::uint64_t rays, std::uint64_t rays_of_branch) {
  return [=](const KernelOptions& options, const TileJob& job, TileResult& result) {
    const auto branches = static_cast<std::uint32_t>(options.branches);
    const auto both = static_cast<float>(std::sqrt(3 * alike)),
               each = static_cast<float>(std::sqrt(3 * own / branches));
    for (std::uint32_t k = 0; k < static_cast<std::uint32_t>(job.tiles); ++k)
      for (std::uint32_t i = 0; i < tile_pixels; ++i)
        for (std::uint32_t c = 0; c < 3; ++c)
          result.radiance[c][k * tile_pixels + i] = 1 + both * noise(options.seed, job, k, i, c) +
                                                    each * noise(options.seed, job, k, i, 3 * branches + c);
    result.rays += static_cast<std::uint64_t>(job.tiles) * (rays + branches * rays_of_branch);
  };
}

BranchGain found(double alike, double own, std::uint64_t rays, std::uint64_t rays_of_branch, int side = 512) {
  return find_branches({side, side, false, 1, branching(alike, own, rays, rays_of_branch)}, {});
}

}  // namespace

TEST_CASE("branches are judged by the noise that they lessen and by their rays, which count 1.3 times") {
  const BranchGain all = found(0, 0.01, 1000, 500);
  CHECK(all.gain == Approx(2 * 1650 / 2300.).epsilon(0.05));
  CHECK(all.error < 1.15);
  // of what both have alike half is left in 16 samples, four times as many as the pilot's
  CHECK(found(0.01, 0.01, 1000, 500).gain == Approx(1.5 / 1.0 * 1650 / 2300).epsilon(0.05));
  CHECK(found(0.01, 0, 1000, 500).gain < 0.8);
  CHECK(found(0, 0.01, 0, 500).gain == Approx(1).epsilon(0.05));  // nothing is spared
  CHECK(found(0, 0.01, 1000, 500, 56).gain == 1);                 // of 49 tiles
}

TEST_CASE("the pilot of branches takes 2.5 % of 16 samples, or its first tiles") {
  for (const int side : {64, 128, 256, 512}) {
    double rays = 0;
    const RenderJob render = branching(0.01, 0.01, 1000, 500);
    const RenderJob job = [&](const KernelOptions& options, const TileJob& tile, TileResult& result) {
      const std::uint64_t before = result.rays;
      render(options, tile, result);
      rays += static_cast<double>(result.rays - before);
    };
    find_branches({side, side, false, 1, job}, {});
    const double image = 16.0 * side * side / tile_pixels * 1500, first = 2 * 3500 * (side <= 128 ? 4 : 8);
    CAPTURE(side, rays, image, first);
    CHECK(rays <= std::max(0.025 * image, first));
  }
}

TEST_CASE(
    "branches are taken where they gain a tenth and more than half of their error, and paths are plain") {
  for (const auto& [suffixes, gain, error, branches] :
       {std::tuple{0, 1.3, 1.2, 2}, {0, 1.3, 2.0, 1}, {0, 1.05, 1.0, 1}, {64, 1.8, 1.0, 1}}) {
    Plan plan;
    plan.suffixes = suffixes;
    choose_two_branches(plan, gain, error);
    CHECK(plan.branches == branches);
  }
}
