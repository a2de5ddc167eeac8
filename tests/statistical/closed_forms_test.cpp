#include <catch2/catch.hpp>

#include <array>
#include <functional>

#include "integrators.h"
#include "reference_images.h"
#include "test_scenes.h"

using namespace castray;
using namespace castray::test;

// Renders against values that are known exactly.

namespace {

/// z-scores of every pixel over independent renders against one expected image.
BlockScores pixel_scores(const Scene& scene, RenderOptions options, const Image& expected,
                         std::uint64_t seeds) {
  std::vector<std::vector<double>> renders;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    options.seed = seed;
    renders.push_back(block_means(render(scene, options).film.image(), 1));
  }
  const std::vector<double> exact = block_means(expected, 1);
  return block_scores(renders, exact, std::vector<double>(exact.size()));
}

/// Irradiance at `p`, normal `n`, from a polygon of radiance 1 wholly above the horizon (Lambert 1760).
double lambert_irradiance(const Vec3d& p, const Vec3d& n, const std::array<Vec3d, 4>& polygon) {
  double sum = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3d a = normalize(polygon[i] - p), b = normalize(polygon[(i + 1) % polygon.size()] - p);
    sum += std::acos(dot(a, b)) * dot(n, normalize(cross(a, b)));
  }
  return std::abs(sum) / 2;
}

/// The floor y = 0, |x|, |z| < 1, which fills the view, by its radiance at the pixels' centres.
Image floor_image(const Camera& camera, int size, const std::function<double(const Vec3d&)>& radiance) {
  Image image(size, size);
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      const Vec3d direction = camera.direction(x + 0.5, y + 0.5, size, size);
      const Vec3d p = camera.position + direction * (-camera.position.y / direction.y);
      REQUIRE(std::max(std::abs(p.x), std::abs(p.z)) < 1);
      image.at(x, y) = Vec3f(static_cast<float>(radiance(p)));
    }
  return image;
}

}  // namespace

TEST_CASE("a closed box that emits e and reflects k has radiance e / (1 - k)", "[statistical]") {
  Scene scene = standard_scene("furnace");
  for (const double k : {0.5, 0.8}) {
    for (Material& material : scene.materials) material.kd = Vec3d(k);
    const RenderOptions options = reference_options(8, 8, 4096);
    const Image image = render(scene, options).film.image();
    Mean mean;
    for (const Vec3f& pixel : image.pixels) mean.add(pixel.y * (1 - k));
    CAPTURE(k, mean.mean(), mean.error());
    CHECK(std::abs(mean.mean() - 1) < 1e-3);
    CHECK(std::abs(mean.mean() - 1) < 4 * mean.error());
    for (const Vec3f& pixel : image.pixels)  // 64 pixels: 5 standard errors are exceeded once in 27000 runs
      CHECK(std::abs(pixel.y * (1 - k) - 1) < 5 * mean.error() * 8);
  }
}

TEST_CASE("direct light of a rectangle is Lambert's polygon formula", "[statistical]") {
  const std::array<Vec3d, 4> light = {Vec3d{-0.3, 0.7, -0.2}, Vec3d{0.4, 0.7, -0.2}, Vec3d{0.4, 0.7, 0.5},
                                      Vec3d{-0.3, 0.7, 0.5}};
  constexpr double kd = 0.6, radiance = 3;
  constexpr int size = 12;
  SceneSketch sketch;
  const auto floor = sketch.add_material({.name = "floor", .kd = Vec3d(kd)});
  const auto lamp = sketch.add_material({.name = "lamp", .kd = Vec3d(0.5), .ke = Vec3d(radiance)});
  sketch.add_quad({-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, {-1, 0, -1}, floor);
  sketch.add_quad(Vec3f(light[0]), Vec3f(light[1]), Vec3f(light[2]), Vec3f(light[3]), lamp);
  sketch.scene.camera = make_camera({0, 0.6, 1.2}, {0, 0, 0}, {0, 1, 0}, 20);

  const Image expected = floor_image(sketch.scene.camera, size, [&](const Vec3d& p) {
    return kd / 3.141592653589793 * radiance * lambert_irradiance(p, {0, 1, 0}, light);
  });
  RenderOptions options = reference_options(size, size, 128);
  options.max_depth = 2;
  options.jitter = false;
  for (const Switch mis : {Switch::off, Switch::on}) {
    options.mis = mis;
    const BlockScores scores = pixel_scores(sketch.scene, options, expected, 16);
    CAPTURE(scores.largest, scores.rms);
    CHECK(scores.largest < score_limit(scores.count / 3, 1e-3));  // the three channels are one
    CHECK(scores.rms < 1.25);  // 144 scores: 1 has a standard error of 0.06
  }
}

// The roof is the scene's highest plane, the floor its lowest: what no segment between two points of the
// scene crosses still hides the sky. 18 ways of 144 pixels; the three channels are one.
TEST_CASE("a black roof takes from the sky what Lambert's polygon formula says", "[statistical]") {
  const std::array<Vec3d, 4> roof = {Vec3d{-0.6, 0.5, -0.4}, Vec3d{0.3, 0.5, -0.4}, Vec3d{0.3, 0.5, 0.5},
                                     Vec3d{-0.6, 0.5, 0.5}};
  constexpr double kd = 0.6, sky = 2;
  constexpr int size = 12;
  SceneSketch sketch;
  const auto floor = sketch.add_material({.name = "floor", .kd = Vec3d(kd)});
  const auto black = sketch.add_material({.name = "black", .kd = Vec3d(0)});
  sketch.add_quad({-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, {-1, 0, -1}, floor);
  sketch.add_quad(Vec3f(roof[0]), Vec3f(roof[1]), Vec3f(roof[2]), Vec3f(roof[3]), black);
  sketch.scene.environment = Vec3d(sky);
  sketch.scene.camera = make_camera({0, 0.45, 1.2}, {0, 0, 0}, {0, 1, 0}, 12);
  const Image expected = floor_image(sketch.scene.camera, size, [&](const Vec3d& p) {
    return kd * sky * (1 - lambert_irradiance(p, {0, 1, 0}, roof) / 3.141592653589793);
  });
  for (const Way& way : every_way(wavefront_options(size, 32, 1))) {
    RenderOptions options = way.options;
    options.jitter = false;
    const BlockScores scores = pixel_scores(sketch.scene, options, expected, 16);
    CAPTURE(way.name, scores.largest, scores.rms);
    CHECK(scores.count == 3 * size * size);
    CHECK(scores.largest < score_limit(scores.count / 3, 1e-4));
    CHECK(scores.rms < 1.3);  // neighbours that share paths are not independent
  }
}

TEST_CASE("float and double agree", "[statistical]") {
  // the same random numbers: what differs is rounding, and whole paths where rounding turns a decision
  for (const char* name : {"cornell_box", "cornell_conductor", "cornell_microfacet"}) {
    const Scene scene = standard_scene(name);
    std::vector<std::vector<double>> differences;
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
      RenderOptions options = reference_options(64, 64, 4, seed);
      std::vector<double> difference = block_means(render(scene, options).film.image(), 8);
      options.precision = Precision::float64;
      const std::vector<double> wide = block_means(render(scene, options).film.image(), 8);
      for (std::size_t i = 0; i < wide.size(); ++i) difference[i] -= wide[i];
      differences.push_back(std::move(difference));
    }
    const std::vector<double> zero(differences[0].size());
    double sum = 0;
    for (const auto& d : differences)
      for (const double v : d) sum += v;
    CAPTURE(name);
    CHECK(std::abs(sum / static_cast<double>(16 * zero.size())) < 1e-3);
  }
}
