#include <catch2/catch.hpp>

#include <cmath>
#include <functional>
#include <numbers>

#include "castray_blocks.h"
#include "generate/shapes.h"
#include "integrators.h"
#include "materials/environment_image.h"
#include "materials/texture.h"
#include "test_scenes.h"

using namespace castray;
using namespace castray::test;

// Light from outside the scene: against values that are known exactly, and the wavefront, in all its forms,
// against castRay in double precision.

namespace {

Scene on_boxes(const std::function<void(Material&)>& change) {
  Scene scene = standard_scene("kinds/sky_and_ground");
  for (std::size_t m = 1; m < scene.materials.size(); ++m) change(scene.materials[m]);
  return scene;
}

/// A rough ball of 20 times frequency^2 triangles on a floor, under a blue sky and a lamp.
Scene ball_outdoors(std::uint32_t frequency, const Material& material) {
  SceneSketch sketch;
  const auto floor = sketch.add_material({.name = "floor", .kd = {.5, .4, .3}});
  const auto lamp = sketch.add_material({.name = "lamp", .kd = Vec3d(0.5), .ke = Vec3d(20)});
  const auto ball = sketch.add_material(material);
  sketch.add_quad({-1, -.4f, 1}, {1, -.4f, 1}, {1, -.4f, -1}, {-1, -.4f, -1}, floor);
  sketch.add_quad({.7f, .9f, -.1f}, {.9f, .9f, -.1f}, {.9f, .9f, .1f}, {.7f, .9f, .1f}, lamp);
  const Shape shape = blob(frequency, 1);
  sketch.add_mesh(shape.positions, shape.triangles, 0.4, {}, false, ball);
  sketch.scene.environment = {.3, .5, .9};
  sketch.scene.camera = make_camera({0.4, 0.5, 1.8}, {0, -0.1, 0}, {0, 1, 0}, 35);
  return sketch.scene;
}

/// The scene under an image of so many texels.
Scene under(Scene scene, const Image& image, double rotation = 0) {
  scene.environment_image = {static_cast<int>(scene.textures.size()), 1, rotation};
  scene.textures.push_back(make_texture("sky", image));
  scene.environment = mean_environment(scene);
  return scene;
}

/// A blue sky, brighter above, with a sun of one texel, over a black lower half.
Image sunny_sky() {
  Image image(32, 16);
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 32; ++x)
      image.at(x, y) = Vec3f(.2f, .3f, .5f) * (1.5f - 0.15f * static_cast<float>(y));
  image.at(19, 4) = {300, 280, 200};
  return image;
}

Scene plane(const Vec3d& albedo) {
  SceneSketch sketch;
  const auto ground = sketch.add_material({.name = "ground", .kd = albedo});
  sketch.add_quad({-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, {-1, 0, -1}, ground);
  sketch.scene.camera = make_camera({0, 0.2, 0.4}, {0, 0, 0}, {0, 1, 0}, 20);
  return sketch.scene;
}

}  // namespace

TEST_CASE("a plane under a constant sky reflects its albedo of it, without noise") {
  const Vec3d albedo{0.2, 0.5, 0.9}, sky{3, 1, 0.5};
  Scene scene = plane(albedo);
  scene.environment = sky;
  for (const Way& way : every_way(wavefront_options(24, 3, 5))) {
    const Image image = render(scene, way.options).film.image();
    for (const Vec3f& pixel : image.pixels)
      for (int c = 0; c < 3; ++c) {
        CAPTURE(way.name, c);
        REQUIRE(pixel[c] == Approx(albedo[c] * sky[c]).epsilon(1e-5));
      }
  }
}

TEST_CASE("what shines from an image is seen where docs/scenes.md says") {
  Image image(8, 4);
  for (int i = 0; i < 32; ++i) image.pixels[static_cast<std::size_t>(i)] = Vec3f(static_cast<float>(1 + i));
  struct View {
    Vec3d towards;
    float value;
  };
  const double across = std::cos(0.3), up = std::sin(0.3);
  // the second row from the top; columns from -z over +x and +z to -x
  const View views[] = {{{across * .38, up, -across * .92}, 9},
                        {{across * .92, up, -across * .38}, 10},
                        {{across * .92, up, across * .38}, 11},
                        {{across * .38, up, across * .92}, 12},
                        {{-across * .38, up, across * .92}, 13},
                        {{-across * .92, up, -across * .38}, 15},
                        {{.1, 1, -.2}, 1},
                        {{.1, -1, -.2}, 25}};
  for (const View& view : views)
    for (const double rotation : {0., 90., -270.}) {
      Scene scene = under(plane({}), image, rotation);
      for (Vec3f& p : scene.positions) p = p * 0.01f + Vec3f(0.9f, 0, 0.9f);  // out of sight
      // turning the image by 90 degrees from +z to +x shows at +x what was at +z
      const Vec3d& w = view.towards;
      const Vec3d seen = rotation == 0 ? w : Vec3d{w.z, w.y, -w.x};
      scene.camera = make_camera({0, 0.5, 0}, Vec3d{0, 0.5, 0} + seen, {0, 0.9, 0.1}, 1);
      for (const Way& way : every_way(wavefront_options(8, 1, 1))) {
        const Vec3f pixel = render(scene, way.options).film.image().at(3, 3);
        CAPTURE(way.name, rotation, view.value);
        CHECK(pixel.x == Approx(view.value));
      }
    }
}

// One texel, from 45 to 67.5 degrees off the zenith and a sixteenth of a turn wide, shines. 18 ways.
TEST_CASE("a plane reflects what a patch of the sky sends it", "[statistical]") {
  Image image(16, 8);
  image.at(5, 2) = Vec3f(50);
  const Scene scene = under(plane(Vec3d(0.6)), image, 77);
  const double pi = std::numbers::pi, low = std::sin(pi * 3 / 8), high = std::sin(pi / 4);
  const double irradiance = 50 * (2 * pi / 16) * (low * low - high * high) / 2;
  for (const Way& way : every_way(wavefront_options(16, 8, 1))) {
    Mean mean;
    RenderOptions options = way.options;
    for (options.seed = 1; options.seed <= 24; ++options.seed) {
      double sum = 0;
      for (const Vec3f& p : render(scene, options).film.image().pixels) sum += static_cast<double>(p.y) / 256;
      mean.add(sum);
    }
    CAPTURE(way.name, mean.mean(), mean.error());
    CHECK(std::abs(mean.mean() - 0.6 / pi * irradiance) < 5 * mean.error() + 1e-6);
    CHECK(mean.error() < 0.01 * mean.mean());
  }
}

// 24 seeds of 3 channels and 18 ways: one false alarm in 290.
TEST_CASE("white boxes in a white sky cannot be told from it", "[statistical]") {
  Scene scene = on_boxes([](Material&) {});
  for (Material& m : scene.materials) m.kd = Vec3d(1);
  for (const Way& way : every_way(wavefront_options(16, 8, 1))) {
    Mean mean[3];
    RenderOptions options = way.options;
    for (options.seed = 1; options.seed <= 24; ++options.seed) {
      Vec3d sum;
      for (const Vec3f& p : render(scene, options).film.image().pixels) sum += Vec3d(p);
      for (int c = 0; c < 3; ++c) mean[c].add(sum[c] / 256);
    }
    for (int c = 0; c < 3; ++c) {
      CAPTURE(way.name, c, mean[c].mean(), mean[c].error());
      CHECK(std::abs(mean[c].mean() - 1) < 5 * mean[c].error() + 1e-6);
      CHECK(mean[c].error() < 0.01);
    }
  }
}

TEST_CASE("outdoors the wavefront agrees with castRay", "[statistical]") {
  for (const char* name : {"kinds/sky_and_ground", "kinds/sun_and_sky", "kinds/window_room"})
    check_scene(name, standard_scene(name));
}

TEST_CASE("every form of the wavefront has the same mean outdoors", "[statistical]") {
  const Scene scene = standard_scene("kinds/sky_and_ground");
  const Expected expected(scene);
  expected.check_each_kernel(scene);
  expected.check_with("generic list", scene, [](RenderOptions& o) { o.generic = true; });
  expected.check_with("generic tree", scene,
                      [](RenderOptions& o) { o.accel = AccelKind::bvh, o.generic = true; });
  expected.check_with("MIS", scene, [](RenderOptions& o) { o.mis = Switch::on; });
  expected.check_with("independent numbers", scene,
                      [](RenderOptions& o) { o.sampler = SamplerKind::independent; });
  expected.check_with("fixed roulette", scene, [](RenderOptions& o) { o.rr = 0.7; });
  for (const int suffixes : {1, 4, 16, 64})
    expected.check_with(std::to_string(suffixes) + " suffixes", scene, [&](RenderOptions& o) {
      o.reuse = {false, 8, 8, suffixes};
    });
}

TEST_CASE("under an image of a sky the wavefront agrees with castRay", "[statistical]") {
  check_scene("boxes", under(standard_scene("kinds/sky_and_ground"), sunny_sky(), 30));
  check_scene("with a lamp", under(standard_scene("kinds/sun_and_sky"), sunny_sky(), 200));
  check_scene("half there", under(on_boxes([](Material& m) { m.coverage = 0.5; }), sunny_sky(), 30));
  const Material white{.name = "white", .kd = Vec3d(0.8)};
  const Material glass{.name = "glass", .type = MaterialType::dielectric, .alpha = 0.4};
  for (const Material& material : {white, glass})
    check_scene(material.name, under(ball_outdoors(12, material), sunny_sky(), 100));
}

// The sun is found from glossy ends of suffixes by chance, rarely and brightly: with few samples the means
// are far from normally distributed.
TEST_CASE("under an image of a sky the wavefront agrees with castRay on metal", "[statistical]") {
  const Scene scene =
      under(on_boxes([](Material& m) { m.type = MaterialType::conductor, m.alpha = 0.3; }), sunny_sky(), 30);
  const Expected expected(scene, wavefront_options(64));
  expected.check("shared", scene, wavefront_options(64), 96);
  expected.check("plain", scene, plain(wavefront_options(16)));
}

TEST_CASE("every form of the wavefront has the same mean under an image of a sky", "[statistical]") {
  const Scene scene = under(standard_scene("kinds/sky_and_ground"), sunny_sky(), 30);
  const Expected expected(scene);
  expected.check_each_kernel(scene);
  expected.check_with("generic", scene, [](RenderOptions& o) { o.accel = AccelKind::bvh, o.generic = true; });
  expected.check_with("no MIS", scene, [](RenderOptions& o) { o.mis = Switch::off; });
  expected.check_with("independent numbers", scene,
                      [](RenderOptions& o) { o.sampler = SamplerKind::independent; });
  for (const int suffixes : {4, 64})
    expected.check_with(std::to_string(suffixes) + " suffixes", scene, [&](RenderOptions& o) {
      o.reuse = {false, 8, 8, suffixes};
    });
}

TEST_CASE("outdoors the wavefront agrees with castRay on every material", "[statistical]") {
  const auto boxes = [](const std::string& name, const std::function<void(Material&)>& change) {
    check_scene(name, on_boxes(change));
  };
  boxes("metal", [](Material& m) { m.type = MaterialType::conductor, m.alpha = 0.3; });
  boxes("narrow", [](Material& m) { m.type = MaterialType::conductor, m.alpha = 0.05; });
  boxes("mirror", [](Material& m) { m.type = MaterialType::conductor, m.alpha = 0; });
  boxes("satin", [](Material& m) { m.type = MaterialType::microfacet, m.alpha = 0.2, m.ks = Vec3d(0.4); });
  boxes("half there", [](Material& m) { m.coverage = 0.5; });
  boxes("black", [](Material& m) { m.kd = Vec3d(0); });
}

TEST_CASE("outdoors the wavefront agrees with castRay on meshes", "[statistical]") {
  check_scene("rough glass",
              ball_outdoors(3, {.name = "glass", .type = MaterialType::dielectric, .alpha = 0.4}));
  for (const std::uint32_t frequency : {3u, 24u}) {
    const std::string triangles = std::to_string(20 * frequency * frequency) + " triangles";
    check_scene(triangles, ball_outdoors(frequency, {.name = "white", .kd = Vec3d(0.8)}));
    Material metal{.name = "metal", .type = MaterialType::conductor, .alpha = 0.3};
    check_scene(triangles + " of metal", ball_outdoors(frequency, metal));
  }
}

TEST_CASE("a limited depth means the same outdoors", "[statistical]") {
  const Scene scene = standard_scene("kinds/sun_and_sky");
  for (const int depth : {2, 3}) {
    RenderOptions options = wavefront_options(4);
    options.max_depth = depth;
    const Expected expected(scene, options);
    expected.check("depth " + std::to_string(depth), scene, options);
    expected.check("depth " + std::to_string(depth) + ", plain", scene, plain(options));
  }
}
