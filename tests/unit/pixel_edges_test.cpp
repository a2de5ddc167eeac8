#include <catch2/catch.hpp>

#include <cmath>

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
