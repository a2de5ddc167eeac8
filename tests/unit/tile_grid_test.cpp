#include "wavefront/tile_grid.h"

#include <catch2/catch.hpp>

#include <set>
#include <utility>

using namespace castray;

TEST_CASE("8 samples in a row have the edges of tiles in columns of their own, 64 all grids") {
  constexpr Window window{64, 64, 0, 0, 64, 64};
  KernelOptions options{};
  options.suffixes = tile_pixels;
  for (options.seed = 1; options.seed < 4; ++options.seed)
    for (const std::uint64_t first : {std::uint64_t{0}, std::uint64_t{64}, std::uint64_t{1} << 20}) {
      std::set<std::pair<int, int>> grids;
      for (std::uint64_t begin = first; begin < first + 64; begin += 8) {
        std::set<int> columns, rows;
        for (std::uint64_t sample = begin; sample < begin + 8; ++sample) {
          const TileGrid grid(window, options, sample);
          columns.insert(grid.shift_x);
          rows.insert(grid.shift_y);
          grids.emplace(grid.shift_x, grid.shift_y);
        }
        CHECK(columns.size() == 8);
        CHECK(rows.size() == 8);
      }
      CHECK(grids.size() == 64);
    }
}

TEST_CASE("two takes of a sample have the edges of tiles in the middle of the other's") {
  constexpr Window window{64, 64, 0, 0, 64, 64};
  KernelOptions options{};
  options.suffixes = tile_pixels;
  for (options.seed = 1; options.seed < 20; ++options.seed) {
    const TileGrid first(window, options, 0, 0), second(window, options, 0, 1);
    CHECK((first.shift_x + tile_size / 2) % tile_size == second.shift_x);
    CHECK((first.shift_y + tile_size / 2) % tile_size == second.shift_y);
  }
}
