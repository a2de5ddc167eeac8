#include "lights/emission_guide.h"

#include <catch2/catch.hpp>

#include "guide_bins.h"
#include "wavefront/learn_emission.h"

using namespace castray;
using namespace castray::test;

namespace {

/// The probability of each bin of the row of the cell that holds p.
std::vector<double> probabilities(const EmissionGuideTable& table, const Vec3f& p) {
  std::uint32_t cell = 0;
  for (int k = 2; k >= 0; --k)
    cell = cell * table.cells[k] + static_cast<std::uint32_t>((p[k] - table.lower[k]) * table.cells_per_unit);
  REQUIRE(table.row_of_cell[cell] != no_guide);
  return probabilities_of(table.cumulative + std::size_t{table.row_of_cell[cell]} * (guide_bins + 1));
}

}  // namespace

TEST_CASE("an emission guide without samples is empty") { CHECK(!EmissionGuide().table().row_of_cell); }

TEST_CASE("an emission guide has the shares of the directions in which useful light leaves, place by place") {
  const Vec3f here(0, 0, 0), there(8, 0, 0);
  const Vec3f down = normalize(Vec3f(middle_of_step(6), -1, middle_of_step(2))),
              right = normalize(Vec3f(1, middle_of_step(5), middle_of_step(0)));
  const EmissionGuide guide({{here, down, 3}, {here, right, 1}, {there, right, 5}});
  // Face -y has the axes z, x; face +x has y, z.
  const std::size_t of_down = guide_bin(3, 2, 6), of_right = guide_bin(0, 5, 0);
  const std::vector<double> near = probabilities(guide.table(), here);
  CHECK(near[of_down] == Approx(0.75).margin(1e-6));
  CHECK(near[of_right] == Approx(0.25).margin(1e-6));
  const std::vector<double> far = probabilities(guide.table(), there);
  CHECK(far[of_right] == Approx(1).margin(1e-6));
}

TEST_CASE("with a guide as many light paths are traced as are as often useful as without") {
  CHECK(light_paths_enough(100, 400) == Approx(0.25));
  CHECK(light_paths_enough(0, 0) == 1);
  CHECK(light_paths_enough(400, 390) == 1);
  CHECK(light_paths_enough(400, 700) == 1);
  CHECK(light_paths_enough(1, 1000) == Approx(1.0 / 16));
}
