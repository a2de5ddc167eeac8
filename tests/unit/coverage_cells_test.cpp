#include "materials/coverage_cells.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <random>

#include "geometry/geometry_records.h"
#include "materials/coverage.h"
#include "materials/texture.h"
#include "test_scenes.h"

using namespace castray;
using namespace castray::test;

namespace {

/// A disc that is there, with a soft rim of one texel, in a square that is not.
Image disc(int size) {
  Image image(size, size);
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      const double dx = x + 0.5 - size / 2., dy = y + 0.5 - size / 2.;
      const auto there = static_cast<float>(std::clamp(size * 0.4 - std::sqrt(dx * dx + dy * dy), 0., 1.));
      image.at(x, y) = {there, there, there};
    }
  return image;
}

/// Two triangles of two squares each, whose texture coordinates are those of a unit square times `scale`,
/// turned, and moved.
Scene masked_squares(const TextureMap& map, double scale, double turn, double move) {
  SceneSketch sketch;
  const auto material = sketch.add_material({.name = "m"});
  sketch.add_quad({-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, material);
  sketch.add_quad({-1, -1, 1}, {1, -1, 1}, {1, 1, 1}, {-1, 1, 1}, material);
  Scene& scene = sketch.scene;
  for (const auto [u, v] : {std::array{0., 0.}, {1., 0.}, {1., 1.}, {0., 1.}})
    scene.uvs.push_back({static_cast<float>(move + scale * (u * std::cos(turn) - v * std::sin(turn))),
                         static_cast<float>(move + scale * (u * std::sin(turn) + v * std::cos(turn)))});
  scene.triangle_uvs = {{0, 1, 2}, {0, 2, 3}, {0, 1, 2}, {0, 2, 3}};
  scene.textures.push_back(make_texture("mask", disc(32)));
  scene.materials[material].map(SurfaceParameter::coverage) = map;
  return scene;
}

std::uint32_t cell_at(const CoverageCells& cells, std::uint32_t triangle, float b1, float b2) {
  const auto side = static_cast<float>(cells.side());
  const auto i = static_cast<std::size_t>(b2 * side) * cells.side() + static_cast<std::size_t>(b1 * side);
  return cells.cells()[cells.grids()[triangle] + i / 16] >> (2 * (i % 16)) & 3;
}

/// How many of some points their cells leave open. All others are what their cells say.
int left_open(const Scene& scene) {
  const CoverageCells cells(scene);
  const Coverage coverage(scene);
  REQUIRE(cells.side() > 0);
  std::mt19937 engine(1);
  std::uniform_real_distribution<float> uniform;
  int open = 0, wrong = 0;
  for (int i = 0; i < 4000; ++i) {
    const float a = uniform(engine), b = uniform(engine), b1 = std::min(a, b), b2 = std::max(a, b) - b1;
    const std::uint32_t triangle = static_cast<std::uint32_t>(i % 2), cell = cell_at(cells, triangle, b1, b2);
    const float share = coverage.share_there(Hit<float>{0, triangle, b1, b2, Scene::no_index}, {0, 0, 1});
    open += cell == cell_mixed;
    wrong += (cell == cell_there && share < 1 - 1e-6f) || (cell == cell_missing && share > 0);
  }
  CHECK(wrong == 0);
  return open;
}

}  // namespace

TEST_CASE("cells of coverage are right wherever they tell, and leave open only what is near the mask's rim") {
  TextureMap map{.texture = 0};
  CHECK(left_open(masked_squares(map, 1, 0, 0)) < 2000);
  CHECK(left_open(masked_squares(map, 0.3, 0.5, 0.6)) < 2000);
  for (const double turn : {0.4, 2.0, 4.0})
    for (const double move : {0.1, -7.3, 1000.0}) {
      INFO(turn << " " << move);
      for (const bool clamp : {false, true}) {
        map.clamp = clamp;
        CHECK(left_open(masked_squares(map, 2.5, turn, move)) < 4000);
      }
    }
  map = {.texture = 0, .scale = {-2, 1.5f}, .offset = {0.2f, 0.3f}, .base = 1, .gain = -1};
  CHECK(left_open(masked_squares(map, 1, 0.2, 0)) < 2600);
}

TEST_CASE("triangles with the same texture coordinates share their cells") {
  Scene scene = masked_squares({.texture = 0}, 1, 0, 0);
  const CoverageCells cells(scene);
  CHECK(cells.grids()[0] != cells.grids()[1]);
  CHECK(cells.grids()[0] == cells.grids()[2]);
  CHECK(cells.grids()[1] == cells.grids()[3]);
}

TEST_CASE("there are no cells where a direction decides, or nothing tells a place in the image") {
  Scene window = masked_squares({.texture = 0}, 1, 0, 0);
  window.materials.back().type = MaterialType::dielectric;
  window.materials.back().thin = true;
  CHECK(CoverageCells(window).side() == 0);
  Scene bare = masked_squares({.texture = 0}, 1, 0, 0);
  bare.triangle_uvs.clear();
  CHECK(CoverageCells(bare).side() == 0);
}
