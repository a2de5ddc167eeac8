#include <catch2/catch.hpp>

#include "box_scenes.h"
#include "integrators.h"

// Shafts leave out triangles of a closed surface that face what they are seen from. Where no two triangles
// share a position there is no such surface, and all of them are tested.

using namespace castray;
using namespace castray::test;

namespace {

/// Two blobs that pass through each other, and a sheet with an edge that pixels see, in a room that glows.
Scene blobs_and_a_sheet() {
  SceneSketch sketch;
  const auto white = sketch.add_material({.name = "white", .kd = Vec3d(0.8)});
  const auto glowing = sketch.add_material({.name = "glowing", .kd = Vec3d(0.5), .ke = Vec3d(1)});
  const Shape shape = blob(16, 1), ground = make_shape("terrain", 4000, 1);
  sketch.add_cube(1, {}, true, glowing);
  sketch.add_mesh(shape.positions, shape.triangles, 0.3, {-0.2, 0, -0.4}, false, white);
  sketch.add_mesh(shape.positions, shape.triangles, 0.35, {0.2, 0.1, -0.3}, true, white);
  sketch.add_mesh(ground.positions, ground.triangles, 0.7, {0, -0.6, 0}, false, white);
  sketch.scene.camera = make_camera({0.1, 0.3, 0.9}, {0, -0.1, -0.4}, {0, 1, 0}, 70);
  return sketch.scene;
}

/// A terrain that has a hole, and another one below it, tilted and turned round, in a room that glows: most
/// tiles see an edge.
Scene sheets() {
  SceneSketch sketch;
  const auto white = sketch.add_material({.name = "white", .kd = Vec3d(0.8)});
  const auto glowing = sketch.add_material({.name = "glowing", .kd = Vec3d(0.5), .ke = Vec3d(1)});
  const Shape ground = make_shape("terrain", 4000, 1);
  std::vector<Index3> with_hole;
  for (const Index3& t : ground.triangles)
    if (length(ground.positions[t[0]] - Vec3d(0.2, ground.positions[t[0]].y, 0.1)) > 0.3)
      with_hole.push_back(t);
  std::vector<Vec3d> tilted;
  for (const Vec3d& p : ground.positions) tilted.push_back({p.x - 0.5 * p.y, p.y + 0.5 * p.x, p.z});
  sketch.add_cube(1, {}, true, glowing);
  sketch.add_mesh(ground.positions, with_hole, 0.6, {0, -0.2, -0.2}, false, white);
  sketch.add_mesh(tilted, ground.triangles, 0.7, {0.1, -0.45, -0.1}, true, white);
  sketch.scene.camera = make_camera({0.1, 0.3, 0.9}, {0, -0.3, -0.2}, {0, 1, 0}, 70);
  return sketch.scene;
}

/// The same with positions of its own for each triangle.
Scene with_own_positions(const Scene& scene) {
  Scene own = scene;
  own.positions.clear();
  for (Index3& corners : own.triangles)
    for (std::uint32_t& corner : corners) {
      own.positions.push_back(scene.positions[corner]);
      corner = static_cast<std::uint32_t>(own.positions.size()) - 1;
    }
  return own;
}

}  // namespace

TEST_CASE("leaving out triangles that face what they are seen from changes rounding alone") {
  const Scene scene = GENERATE(blobs_and_a_sheet(), sheets()), all = with_own_positions(scene);
  RenderOptions options = wavefront_options(48, 4, 1);
  options.accel = AccelKind::bvh;
  const Image image = render(scene, options).film.image(), expected = render(all, options).film.image();
  int differ = 0;
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    for (int c = 0; c < 3; ++c)
      differ += std::abs(image.pixels[i][c] - expected.pixels[i][c]) > 1e-3f * expected.pixels[i][c];
  CHECK(differ <= 48 * 48 * 3 / 500);
}
