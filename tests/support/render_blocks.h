#pragma once

#include <catch2/catch.hpp>

#include <vector>

#include "castray/render.h"
#include "reference_images.h"

namespace castray::test {

inline constexpr int block = 4;  ///< pixels

/// By render, by block and channel.
using Blocks = std::vector<std::vector<double>>;

/// Block means of renders with independent seeds.
inline Blocks blocks_of(const Scene& scene, RenderOptions options, std::uint64_t seeds) {
  Blocks blocks;
  const PreparedScene prepared(scene, options);
  for (std::uint64_t seed = 0; seed < seeds; ++seed) {
    options.seed = 1000 + seed;
    const RenderResult result = render(prepared, options);
    REQUIRE(result.film.nonfinite_samples == 0);
    blocks.push_back(block_means(image_of(result.film), block));
  }
  return blocks;
}

}  // namespace castray::test
