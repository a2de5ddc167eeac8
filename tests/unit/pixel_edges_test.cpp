#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

#include "castray/render.h"
#include "test_scenes.h"

using namespace castray;
using namespace castray::test;

namespace {

constexpr int side = 64;

/// The pixel in which the camera sees a place of the Cornell box, in millimetres.
std::pair<int, int> pixel_of(const Scene& scene, const Vec3d& place) {
  const Camera& camera = scene.camera;
  const Vec3d to = (place - scene.center) / scene.unit - camera.position;
  const Vec3d at = to / dot(to, camera.forward) / camera.tan_half_fov;
  const auto coordinate = [](double x) { return static_cast<int>(std::floor((x + 1) / 2 * side)); };
  return {coordinate(dot(at, camera.right)), coordinate(-dot(at, camera.up))};
}

}  // namespace

TEST_CASE("pixels that see two surfaces take no part in differences, and all others do") {
  const Scene scene = standard_scene("cornell_box");
  RenderOptions options;
  options.width = options.height = side;
  options.spp = 2;
  options.reconstruct = Switch::on;
  const Film film = render(scene, options).film;
  const auto takes_part = [&](const Vec3d& place) {
    const auto [x, y] = pixel_of(scene, place);
    return film.differences().counts(0, y, DifferenceSums::own)[x] > 0;
  };
  CHECK_FALSE(takes_part({278, 548.8, 227}));  // the lamp's side towards the camera
  CHECK_FALSE(takes_part({185, 165, 93.5}));   // the short box, upper edge
  CHECK_FALSE(takes_part({540, 0, 559.2}));    // floor and back wall
  CHECK_FALSE(takes_part({0, 300, 559.2}));    // red or green and back wall
  CHECK(takes_part({278, 400, 559.2}));        // the back wall
  CHECK(takes_part({450, 0, 100}));            // the floor
  CHECK(takes_part({344, 200, 271.5}));        // a side of the tall box
  CHECK(takes_part({0, 300, 300}));            // a side wall
  int smooth = 0;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x)
      smooth += film.differences().counts(0, y, DifferenceSums::own)[x] > 0 ? 1 : 0;
  CHECK(smooth > side * side * 3 / 4);
}

namespace {

/// Luminance of pixels by render of another seed.
std::vector<std::vector<double>> renders(const Scene& scene, RenderOptions options, std::uint64_t seeds) {
  std::vector<std::vector<double>> all;
  for (options.seed = 0; options.seed < seeds; ++options.seed) {
    all.emplace_back();
    for (const Vec3f& pixel : render(scene, options).film.image().pixels)
      all.back().push_back(luminance(Vec3d(pixel)));
  }
  return all;
}

double variance_of_pixel(const std::vector<std::vector<double>>& renders, std::size_t pixel) {
  double sum = 0, squares = 0;
  for (const std::vector<double>& image : renders) {
    sum += image[pixel];
    squares += image[pixel] * image[pixel];
  }
  const auto n = static_cast<double>(renders.size());
  return (squares - sum * sum / n) / (n - 1);
}

}  // namespace

TEST_CASE("more samples at edges lessen the noise there by their number, and change nothing elsewhere") {
  constexpr int size = 128;
  const Scene scene = standard_scene("cornell_box");
  RenderOptions options;
  options.width = options.height = size;
  options.spp = 4;
  options.reconstruct = Switch::on;
  options.edge_samples = 1;
  const Film film = render(scene, options).film;
  const auto sees_edge = [&](int x, int y) {
    return film.differences().counts(0, y, DifferenceSums::own)[x] == 0;
  };
  const auto is_near_edge = [&](int x, int y) {
    constexpr int tiles_reach = tile_side - 1 + 2 * tile_reach;
    for (int v = std::max(y - tiles_reach, 0); v <= std::min(y + tiles_reach, size - 1); ++v)
      for (int u = std::max(x - tiles_reach, 0); u <= std::min(x + tiles_reach, size - 1); ++u)
        if (sees_edge(u, v)) return true;
    return false;
  };
  const auto once = renders(scene, options, 10);
  options.edge_samples = 3;
  const auto thrice = renders(scene, options, 10);
  const auto sees_lamp = [&](int x, int y) {  // by rays of its own; the pixel beside it is one of the lamp
    for (int v = std::max(y - 1, 0); v <= std::min(y + 1, size - 1); ++v)
      for (int u = std::max(x - 1, 0); u <= std::min(x + 1, size - 1); ++u)
        if (once[0][static_cast<std::size_t>(v * size + u)] > 2) return true;
    return false;
  };
  int far_pixels = 0;
  double before = 0, after = 0;
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      const auto pixel = static_cast<std::size_t>(y * size + x);
      if (!is_near_edge(x, y)) {
        ++far_pixels;
        CHECK(thrice[0][pixel] == once[0][pixel]);
      }
      if (!sees_edge(x, y) || sees_lamp(x, y)) continue;
      before += variance_of_pixel(once, pixel);
      after += variance_of_pixel(thrice, pixel);
    }
  CHECK(far_pixels > 20);
  CAPTURE(before / after);
  CHECK(before > 2.5 * after);
}
