#include "geometry/build_quality.h"

#include <catch2/catch.hpp>

#include "generate/shapes.h"
#include "stress_checks.h"
#include "test_scenes.h"

using namespace castray;
using namespace castray::test;

namespace {

double wasted_by(const Shape& shape) { return wasted_boxes(place(shape).view()); }

/// Sticks under a lamp that fills the top of their cube.
Scene lit_sticks(std::uint32_t triangles) {
  SceneSketch sketch;
  Material wood, lamp;
  wood.kd = {0.7, 0.6, 0.5};
  lamp.ke = {3, 3, 3};
  const std::uint16_t brown = sketch.add_material(wood), light = sketch.add_material(lamp);
  sketch.add_quad({-1, 1, -1}, {1, 1, -1}, {1, 1, 1}, {-1, 1, 1}, light);
  Scene& scene = sketch.scene;
  const Shape shape = sticks(triangles, 1);
  const auto first = static_cast<std::uint32_t>(scene.positions.size());
  for (const Vec3d& p : shape.positions) scene.positions.emplace_back(p);
  for (const Index3& t : shape.triangles) {
    scene.triangles.push_back({first + t[0], first + t[1], first + t[2]});
    scene.triangle_material.push_back(brown);
  }
  scene.camera = make_camera({0, 0, 3}, {0, 0, 0}, {0, 1, 0}, 40);
  return scene;
}

RenderOptions small(BuildQuality build) {
  RenderOptions options;
  options.width = 40;
  options.height = 32;
  options.spp = 4;
  options.build = build;
  return options;
}

}  // namespace

TEST_CASE("wasted boxes are those of long triangles across the axes") {
  Shape stick{{{-1, -1, -1}, {1, 1, 1}, {1, 1, 1}}, {{0, 1, 2}}};
  CHECK(wasted_by(stick) == Approx(1));
  stick.triangles.assign(300, {0, 1, 2});
  CHECK(wasted_by(stick) == Approx(300));
  const Shape square{{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}};
  CHECK(wasted_by(square) == Approx(1));  // halves of their boxes
  CHECK(wasted_boxes({}) == 0);
  for (const std::uint32_t frequency : {4u, 40u}) CHECK(wasted_by(icosphere(frequency)) < 3);
  CHECK(wasted_by(soup(2000, 1)) < 256);
  CHECK(wasted_by(sticks(4000, 1)) > 256);
}

TEST_CASE("boxes are cut where they waste much, and left to itself where it pays") {
  using enum BuildQuality;
  CHECK(choose_build(fast, 1e6, 1000, 1e12) == fast);
  CHECK(choose_build(best, 255, 1000, 1e12) == fast);
  CHECK(choose_build(best, 257, 1000, 0) == best);
  CHECK(choose_build(automatic, 255, 1000, 1e12) == fast);
  // 1000 triangles cost 1.6 ms; a ray gains 2 us
  CHECK(choose_build(automatic, 1000, 1000, 790) == fast);
  CHECK(choose_build(automatic, 1000, 1000, 810) == best);
}

TEST_CASE("the quality of the tree does not show in the image") {
  const Scene scene = lit_sticks(5000);
  for (const bool shared : {false, true}) {
    std::vector<RenderResult> results;
    for (const BuildQuality build : {BuildQuality::fast, BuildQuality::best, BuildQuality::automatic}) {
      RenderOptions options = small(build);
      options.reuse.automatic = shared;
      results.push_back(render(scene, options));
    }
    CHECK(results[0].stats.accel_summary.ends_with("build fast"));
    CHECK(results[1].stats.accel_summary.ends_with("build best"));
    CHECK(results[2].stats.accel_summary.ends_with("build best"));
    const std::vector<Vec3f> a = results[0].film.image().pixels, b = results[1].film.image().pixels;
    CHECK(results[2].film.image().pixels == b);
    if (!shared) CHECK(a == b);
    double difference = 0, sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
      difference += std::abs(luminance(a[i] - b[i]));
      sum += luminance(a[i]);
    }
    CHECK(sum > 0);
    CHECK(difference < 1e-3 * sum);  // shafts may decide what passes an edge within their rounding otherwise
  }
}
