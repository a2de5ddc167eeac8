#include <catch2/catch.hpp>

#include <set>

#include "core/sequences.h"

using namespace castray;

TEST_CASE("every 2^m points of two Sobol dimensions meet every elementary interval once") {
  constexpr int m = 6;
  for (int first : {0, 1 << m, 5 << m})
    for (int a = 0; a < 4; ++a)
      for (int b = 0; b < 4; ++b) {
        if (a == b || (a > 1 || b > 1)) continue;  // only dimensions 0 and 1 form a (0,2)-sequence
        for (int digits_a = 0; digits_a <= m; ++digits_a) {
          std::set<int> cells;
          for (int i = 0; i < 1 << m; ++i) {
            const auto u = sample_block(SamplerKind::sobol, 77, static_cast<std::uint64_t>(first + i), 3);
            const auto cell_a =
                static_cast<int>(u[static_cast<std::size_t>(a)] * static_cast<float>(1 << digits_a));
            const auto cell_b =
                static_cast<int>(u[static_cast<std::size_t>(b)] * static_cast<float>(1 << (m - digits_a)));
            cells.insert(cell_a << m | cell_b);
          }
          REQUIRE(cells.size() == 1u << m);
        }
      }
}

TEST_CASE("every dimension of the sequence is stratified") {
  for (std::size_t d = 0; d < 4; ++d) {
    std::set<int> cells;
    for (std::uint64_t i = 0; i < 256; ++i)
      cells.insert(static_cast<int>(sample_block(SamplerKind::sobol, 5, i, 1)[d] * 256));
    CHECK(cells.size() == 256);
  }
}
