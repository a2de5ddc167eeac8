#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "integrators.h"
#include "same_bytes.h"
#include "statistics.h"
#include "test_scenes.h"

using namespace castray;
using namespace castray::test;

// Parts from a tenth to a millionth of the scene: rounding is to be small beside each of them, not beside the
// scene. A cube that shines, and one that is lit and seen close, in a room of twice the unit.

namespace {

constexpr int side = 16;

/// A cube of half the side `half`, turned so that none of its planes is one of the axes'.
void add_turned_cube(SceneSketch& sketch, double half, const Vec3d& middle, std::uint16_t material) {
  SceneSketch straight;
  straight.add_material({});
  straight.add_cube(1, {}, false, 0);
  const Vec3d x = normalize(Vec3d{0.8, 0.45, -0.4}), z = normalize(cross(x, Vec3d{0.1, 1, 0.3})),
              y = cross(z, x);
  std::vector<Vec3d> corners;
  for (const Vec3f& p : straight.scene.positions) corners.push_back(x * p.x + y * p.y + z * p.z);
  sketch.add_mesh(corners, straight.scene.triangles, half, middle, false, material);
}

SceneSketch room() {
  SceneSketch sketch;
  sketch.add_cube(1, {}, true, sketch.add_material({.name = "white", .kd = Vec3d(0.6)}));
  return sketch;
}

/// Lit by a cube as bright as its size requires, which the camera does not see.
Scene room_with_lamp(double size) {
  SceneSketch sketch = room();
  const Vec3d emission(0.02 / (size * size));
  const auto lamp = sketch.add_material({.name = "lamp", .kd = Vec3d(0.5), .ke = emission});
  add_turned_cube(sketch, size, {0.1, 0.5, 0.8}, lamp);
  sketch.scene.camera = make_camera({0, -0.1, 0.95}, {0, -0.3, -1}, {0, 1, 0}, 70);
  return sketch.scene;
}

/// The camera sees the cube alike whatever its size.
Scene room_with_cube(double size) {
  SceneSketch sketch = room();
  const auto lamp = sketch.add_material({.name = "lamp", .kd = Vec3d(0.5), .ke = Vec3d(15)});
  const auto white = sketch.add_material({.name = "cube", .kd = Vec3d(0.7)});
  sketch.add_quad({-0.3f, 0.99f, -0.3f}, {0.3f, 0.99f, -0.3f}, {0.3f, 0.99f, 0.3f}, {-0.3f, 0.99f, 0.3f},
                  lamp);
  const Vec3d middle{0.1, 0.2, -0.1};
  add_turned_cube(sketch, size, middle, white);
  const double fov = 2 * std::atan(4.4 * size) * 180 / std::numbers::pi;
  sketch.scene.camera = make_camera(middle + Vec3d{0.24, 0.28, 0.33}, middle, {0, 1, 0}, fov);
  return sketch.scene;
}

double mean_of(const PreparedScene& scene, const RenderOptions& options) {
  const RenderResult result = render(scene, options);
  CHECK(result.film.nonfinite_samples == 0);
  double sum = 0;
  for (const Vec3f& pixel : result.film.image().pixels) sum += pixel.y;
  return sum / (side * side);
}

Mean mean_over_seeds(const Scene& scene, RenderOptions options, std::uint64_t seeds) {
  Mean mean;
  const PreparedScene prepared(scene, options);
  for (options.seed = 1; options.seed <= seeds; ++options.seed) mean.add(mean_of(prepared, options));
  return mean;
}

bool is_double(const Way& way) {
  return way.options.integrator == Integrator::reference && way.options.precision == Precision::float64;
}
bool is_list(const Way& way) {
  return way.options.integrator != Integrator::reference && way.options.accel == AccelKind::list;
}

/// A millionth is 17 to 130 steps of float at its place: as seen from the camera, which is no part of it, a
/// cube's corners are rounded by up to a fortieth of its size, except by the list's test in double.
double rounding(const Way& way, double size) { return size < 3e-6 && !is_list(way) ? 0.01 : 0; }

// 9 ways and 6 sizes a scene: |t| > 7.5 with 15 degrees of freedom or more has a probability of 2e-6 each,
// 2e-4 for both scenes. Means are known to 0.1 to 0.9 %. Besides, list and tree render the same samples.
void check_all_sizes(Scene (*make)(double)) {
  constexpr std::uint64_t seeds = 16;
  for (const double size : {1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6}) {
    const Scene scene = make(size);
    const std::vector<Way> ways = every_way(wavefront_options(side, 16, 1), arithmetics());
    check_same_bytes(scene, wavefront_options(side, 2, 1));
    const Mean truth = mean_over_seeds(scene, std::ranges::find_if(ways, is_double)->options, seeds);
    double list[2] = {};  // with plain and with shared paths
    for (const Way& way : ways) {
      if (is_double(way)) continue;
      CAPTURE(size, way.name);
      const Mean found = mean_over_seeds(scene, way.options, seeds);
      CAPTURE(found.mean(), found.error(), truth.mean(), truth.error());
      CHECK(std::abs(found.mean() - truth.mean()) <=
            7.5 * std::hypot(found.error(), truth.error()) + rounding(way, size) * truth.mean());
      if (way.options.integrator == Integrator::reference) continue;
      double& by_list = list[way.options.reuse.automatic];
      if (is_list(way)) by_list = found.mean();
      CHECK(std::abs(found.mean() / by_list - 1) <= 1e-3 + rounding(way, size));
    }
  }
}

}  // namespace

TEST_CASE("lamps of any size light as by the reference in double", "[statistical]") {
  check_all_sizes(room_with_lamp);
}

TEST_CASE("things of any size, seen close, are lit as by the reference in double", "[statistical]") {
  check_all_sizes(room_with_cube);
}
