#include <catch2/catch.hpp>

#include "core/sequences.h"
#include "render/prepared_scene.h"
#include "test_scenes.h"

using namespace castray;
using namespace castray::test;

// Each classic fault is there when asked for and gone by default; docs/classic-faults.md shows them.

namespace {

double brightness(const Image& image) {
  double sum = 0;
  for (const Vec3f& pixel : image.pixels) sum += luminance(Vec3d(pixel));
  return sum / static_cast<double>(image.pixels.size());
}

RenderResult render_with(Fault fault, const Scene& scene, const RenderOptions& options) {
  return render(PreparedAccess::prepare(scene, options, fault), options);
}

Image image_of(const Scene& scene, const RenderOptions& options, Fault fault = Fault::none) {
  return render_with(fault, scene, options).film.image();
}

/// The Cornell box as a file with coordinates scaled and moved would have it.
Scene cornell_at(double scale, double offset) {
  Scene scene = standard_scene("cornell_box");
  scene.unit *= scale;
  scene.center = scene.center * scale + Vec3d(offset);
  return scene;
}

/// Brightness with the classic epsilon over that with error bounds.
double share_left(const Scene& scene, double epsilon) {
  RenderOptions options = reference_options(48, 48, 8);
  const double right = brightness(image_of(scene, options));
  options.epsilon = epsilon;
  return brightness(image_of(scene, options)) / right;
}

/// A floor under two lamps of equal power, red and green, at equal distances from what the camera sees.
Scene two_lamps() {
  SceneSketch sketch;
  const auto floor = sketch.add_material({.name = "floor", .kd = Vec3d(0.5)});
  const auto red = sketch.add_material({.name = "red", .ke = {1 / 0.2126, 0, 0}});
  const auto green = sketch.add_material({.name = "green", .ke = {0, 1 / 0.7152, 0}});
  sketch.add_quad({-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, {-1, 0, -1}, floor);
  const auto add_lamp = [&](float x, std::uint16_t material) {
    sketch.add_quad({x, 1, -0.1f}, {x + 0.2f, 1, -0.1f}, {x + 0.2f, 1, 0.1f}, {x, 1, 0.1f}, material);
  };
  add_lamp(-0.6f, red);
  add_lamp(0.4f, green);
  sketch.scene.camera = make_camera({0, 0.5, 0}, {0, 0, 0}, {0, 0, 1}, 1);
  return sketch.scene;
}

/// Direct light of each lamp, with the fault over without.
Vec3d lamps_seen(Fault fault) {
  const Scene scene = two_lamps();
  RenderOptions options = reference_options(1, 1, 40000);
  options.max_depth = 2;
  const Vec3f right = image_of(scene, options).pixels[0], wrong = image_of(scene, options, fault).pixels[0];
  return {double(wrong.x / right.x), double(wrong.y / right.y), 0};
}

}  // namespace

TEST_CASE("fault 1: a small absolute epsilon darkens the image", "[faults]") {
  CHECK(share_left(cornell_at(1, 0), 1e-5) < 0.8);
  CHECK(share_left(cornell_at(1, 0), 1e-2) == Approx(1).margin(0.02));
}

TEST_CASE("fault 2: the light is black where the camera sees it", "[faults]") {
  const Scene scene = standard_scene("cornell_box");
  RenderOptions options = reference_options(64, 64, 4);
  options.crop = Window{0, 0, 31, 9, 33, 10};  // inside the light
  CHECK(brightness(image_of(scene, options)) > 30);
  CHECK(brightness(image_of(scene, options, Fault::black_light)) < 5);
}

TEST_CASE("fault 3: flat boxes vanish under t_min < t_max", "[faults]") {
  const Scene scene = standard_scene("cornell_box");
  RenderOptions options = reference_options(64, 64, 4);
  options.crop = Window{0, 0, 28, 20, 36, 24};  // the back wall
  CHECK(brightness(image_of(scene, options)) > 0.05);
  CHECK(brightness(image_of(scene, options, Fault::vanishing_boxes)) == 0);
}

TEST_CASE("fault 4: uniform hemisphere sampling meets 0/0, which is shown white", "[faults]") {
  const Scene scene = standard_scene("cornell_box");
  RenderOptions options = reference_options(64, 64, 1);
  options.crop = Window{0, 0, 30, 30, 31, 31};
  const std::uint32_t key = pixel_key(30, 30, options.seed);
  std::uint64_t sample = 0;  // the first one whose bounce has u = 1/2: one in 2^24
  while (sample_block(options.sampler, key, sample, PathBlocks::direction(0))[0] != 0.5f) ++sample;
  options.samples = SampleRange{sample, 1};
  const RenderResult right = render(scene, options), wrong = render_with(Fault::white_specks, scene, options);
  CHECK(right.film.nonfinite_samples == 0);
  CHECK(brightness(right.film.image()) < 1);
  CHECK(wrong.film.image().pixels[0] == Vec3f(1, 1, 1));
}

TEST_CASE("fault 5: an engine built for every number cannot be repeated", "[faults]") {
  const Scene scene = standard_scene("cornell_box");
  const RenderOptions options = reference_options(8, 8, 1);
  CHECK(image_of(scene, options).pixels == image_of(scene, options).pixels);
  CHECK(image_of(scene, options, Fault::slow_random).pixels !=
        image_of(scene, options, Fault::slow_random).pixels);
}

TEST_CASE("fault 6: sqrt(u) gives the first of two equal lights a quarter of the samples", "[faults]") {
  const Vec3d seen = lamps_seen(Fault::skewed_light);  // standard errors of 0.006
  CHECK(seen.x == Approx(0.5).margin(0.03));
  CHECK(seen.y == Approx(1.5).margin(0.03));
  CHECK(lamps_seen(Fault::none) == Vec3d(1, 1, 0));
}

TEST_CASE("fault 7: without the probability of the choice, four equal lights give a quarter", "[faults]") {
  const Vec3d seen = lamps_seen(Fault::no_light_choice);  // a lamp is two triangles
  CHECK(seen.x == Approx(0.25).epsilon(1e-5));
  CHECK(seen.y == Approx(0.25).epsilon(1e-5));
}

TEST_CASE("fault 8: a pixel counter shared by threads scrambles the rows", "[faults]") {
  const Scene scene = standard_scene("cornell_box");
  RenderOptions options = reference_options(64, 64, 4);
  const Image right = image_of(scene, options);
  const Fault fault = Fault::shared_counter;
  options.threads = 1;
  CHECK(image_of(scene, options, fault).pixels == right.pixels);
  options.threads = 4;
  bool scrambled = false;  // threads may happen to take turns
  for (int i = 0; i < 50 && !scrambled; ++i)
    scrambled = image_of(scene, options, fault).pixels != right.pixels;
  CHECK(scrambled);
  CHECK(image_of(scene, options).pixels == right.pixels);
}

TEST_CASE("fault 9: an epsilon that suits one scale and place fails at others", "[faults]") {
  constexpr double epsilon = 2e-3;
  CHECK(share_left(cornell_at(1, 0), epsilon) == Approx(1).margin(0.02));
  CHECK(share_left(cornell_at(128, 0), epsilon) < 0.9);
  CHECK(share_left(cornell_at(1, 1e5), epsilon) < 0.9);
}
