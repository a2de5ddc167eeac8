#include "lights/emission_guide.h"

#include <catch2/catch.hpp>

#include "wavefront/learn_emission.h"

using namespace castray;

namespace {

/// The probability of each bin of the row of the cell that holds p.
std::vector<double> probabilities(const EmissionGuideTable& table, const Vec3f& p) {
  std::uint32_t cell = 0;
  for (int k = 2; k >= 0; --k)
    cell = cell * table.cells[k] + static_cast<std::uint32_t>((p[k] - table.lower[k]) * table.cells_per_unit);
  REQUIRE(table.row_of_cell[cell] != no_guide);
  const float* row = table.cumulative + std::size_t{table.row_of_cell[cell]} * (guide_bins + 1);
  CHECK(row[0] == 0);
  CHECK(row[guide_bins] == 1);
  std::vector<double> bins;
  for (std::size_t i = 0; i < guide_bins; ++i) {
    CHECK(row[i + 1] >= row[i]);
    bins.push_back(double{row[i + 1]} - double{row[i]});
  }
  return bins;
}

/// The bin of the middle of square (a,b) of a face.
std::size_t bin_of(std::size_t face, std::size_t a, std::size_t b) {
  return (face * guide_steps + a) * guide_steps + b;
}

}  // namespace

TEST_CASE("an emission guide without samples is empty") { CHECK(!EmissionGuide().table().row_of_cell); }

TEST_CASE("an emission guide has the shares of the directions in which useful light leaves, place by place") {
  const auto middle = [](std::size_t step) {
    return (static_cast<float>(step) + 0.5f) * 2 / guide_steps - 1;
  };
  const Vec3f here(0, 0, 0), there(8, 0, 0);
  const Vec3f down = normalize(Vec3f(middle(6), -1, middle(2))),
              right = normalize(Vec3f(1, middle(5), middle(0)));
  const EmissionGuide guide({{here, down, 3}, {here, right, 1}, {there, right, 5}});
  // Face -y has the axes z, x; face +x has y, z.
  const std::size_t of_down = bin_of(3, 2, 6), of_right = bin_of(0, 5, 0);
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
