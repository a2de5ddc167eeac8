#include <catch2/catch.hpp>

#include <cmath>
#include <functional>
#include <random>

#include "integrators.h"
#include "materials/texture.h"
#include "render_blocks.h"
#include "same_bytes.h"
#include "statistics.h"
#include "test_scenes.h"

using namespace castray;
using namespace castray::test;

// Surfaces of which only a share is there, on every integrator.

namespace {

constexpr int side = 24;

RenderOptions reference_in_double(std::uint64_t spp) {
  RenderOptions options = reference_options(side, side, spp);
  options.precision = Precision::float64;
  options.threads = 1;
  return options;
}

/// No block of `renders` is off the mean of `expected`, at a false-alarm rate of 1e-4 a call, nor are all of
/// them a little: of 108 scores the root mean square has a standard error of 0.07.
void check_same_mean(const std::string& what, const Blocks& expected, const Blocks& renders) {
  const ExpectedBlocks blocks(expected);
  const BlockScores scores = block_scores(renders, blocks.mean, blocks.variance);
  CAPTURE(what, scores.rms, scores.largest, scores.count);
  CHECK(scores.count > 0);
  CHECK(scores.largest < score_limit(scores.count, 1e-4));
  CHECK(scores.rms < 1.3);
}

/// Black left of u = 0.5, white right of it, but for 1/1000 of the image.
void set_half_mask(Scene& scene, Material& m) {
  Image image(2, 1);
  image.pixels = {Vec3f(0), Vec3f(1)};
  m.map(SurfaceParameter::coverage) = {
      .texture = static_cast<int>(scene.textures.size()), .clamp = true, .base = -499.5f, .gain = 1000};
  scene.textures.push_back(make_texture("half", image));
}

/// Cornell's box whose boxes are there by the given share, or as `change` says.
Scene box_with(const std::string& name, const std::function<void(Material&)>& change) {
  Scene scene = standard_scene(name);
  // the boxes are the last 20 of the box's triangles, of a material of their own
  Material partial = scene.material_of(static_cast<std::uint32_t>(scene.triangles.size() - 1));
  change(partial);
  scene.materials.push_back(partial);
  for (std::size_t i = scene.triangles.size() - 20; i < scene.triangles.size(); ++i)
    scene.triangle_material[i] = static_cast<std::uint16_t>(scene.materials.size() - 1);
  return scene;
}

/// Leaves, rectangles in any direction, between a lamp above, a floor and a dark sky. `masked`: each is a
/// whole one of which an image leaves half; otherwise the half is cut out as triangles.
Scene leaves(std::size_t count, bool masked) {
  SceneSketch sketch;
  Scene& scene = sketch.scene;
  Material green{.name = "leaf", .kd = {.3, .6, .2}};
  if (masked) set_half_mask(scene, green);
  const auto leaf = sketch.add_material(green);
  const auto white = sketch.add_material({.name = "white", .kd = Vec3d(0.7)});
  const auto lamp = sketch.add_material({.name = "lamp", .kd = {}, .ke = Vec3d(8)});
  sketch.add_quad({-.3f, .95f, -.3f}, {.3f, .95f, -.3f}, {.3f, .95f, .3f}, {-.3f, .95f, .3f}, lamp);
  sketch.add_quad({-1, -1, 1}, {1, -1, 1}, {1, -1, -1}, {-1, -1, -1}, white);
  std::minstd_rand random(7);
  std::uniform_real_distribution<float> any(-1, 1);
  const auto vec = [&] { return Vec3f(any(random), any(random), any(random)); };
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3f middle = vec() * 0.6f, along = normalize(vec()), across = normalize(cross(along, vec()));
    const Vec3f u = along * 0.2f, v = across * 0.08f;
    sketch.add_quad(masked ? middle - u - v : middle - v, middle + u - v, middle + u + v,
                    masked ? middle - u + v : middle + v, leaf);
  }
  scene.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  for (std::size_t i = 0; i < scene.triangles.size(); ++i)
    scene.triangle_uvs.push_back(i % 2 ? Index3{0, 2, 3} : Index3{0, 1, 2});
  scene.environment = Vec3d(0.2);
  scene.camera = make_camera({0.5, 0.6, 3}, {0, -0.1, 0}, {0, 1, 0}, 40);
  return scene;
}

/// A floor under a lamp, and between them `count` black sheets of coverage `share`; the camera is below them.
Scene sheets(int count, double share) {
  SceneSketch sketch;
  const auto white = sketch.add_material({.name = "white", .kd = Vec3d(0.8)});
  const auto lamp = sketch.add_material({.name = "lamp", .kd = {}, .ke = Vec3d(5)});
  const auto gauze = sketch.add_material({.name = "gauze", .kd = {}, .coverage = share});
  sketch.add_quad({-.4f, .9f, -.4f}, {.4f, .9f, -.4f}, {.4f, .9f, .4f}, {-.4f, .9f, .4f}, lamp);
  sketch.add_quad({-1, -1, 1}, {1, -1, 1}, {1, -1, -1}, {-1, -1, -1}, white);
  for (int i = 0; i < count; ++i) {
    const float y = 0.2f + 0.2f * static_cast<float>(i);
    sketch.add_quad({-3, y, -3}, {3, y, -3}, {3, y, 3}, {-3, y, 3}, gauze);
  }
  sketch.scene.camera = make_camera({0, 0, 2}, {0, -1, 0}, {0, 1, 0}, 40);
  return sketch.scene;
}

}  // namespace

TEST_CASE("half a coverage shows half of what is behind, on every integrator", "[statistical]") {
  SceneSketch sketch;
  const auto cloth = sketch.add_material({.name = "cloth", .kd = Vec3d(0.8), .coverage = 0.5});
  sketch.add_quad({-9, -9, 0}, {9, -9, 0}, {9, 9, 0}, {-9, 9, 0}, cloth);
  sketch.scene.environment = Vec3d(1);
  sketch.scene.camera = make_camera({0, 0, 3}, {}, {0, 1, 0}, 36);
  check_same_bytes(sketch.scene, wavefront_options(16, 2, 3));
  for (const Way& way : every_way(wavefront_options(16, 64, 3), arithmetics())) {
    Mean mean;
    for (const Vec3f& p : render(sketch.scene, way.options).film.image().pixels) mean.add(p.x);
    CAPTURE(way.name, mean.mean(), mean.error());
    CHECK(std::abs(mean.mean() - 0.9) < 4.5 * mean.error());  // the sky is 1, the cloth 0.8
    CHECK(mean.error() < 0.002);
  }
}

TEST_CASE("sheets thin light by what they leave of it, one after the other", "[statistical]") {
  const double share = 0.3;
  check_same_bytes(sheets(3, share), wavefront_options(16, 2, 3));
  for (const Way& way : every_way(wavefront_options(16, 64, 3), arithmetics()))
    for (const Switch mis : {Switch::off, Switch::on}) {
      RenderOptions options = way.options;
      options.mis = mis;
      const auto brightness = [&](int count) {
        Mean mean;
        const Scene scene = sheets(count, share);
        const PreparedScene prepared(scene, options);
        for (options.seed = 0; options.seed < 16; ++options.seed) {
          double sum = 0;
          for (const Vec3f& p : render(prepared, options).film.image().pixels)
            sum += static_cast<double>(p.x) / (16 * 16);
          mean.add(sum);
        }
        return mean;
      };
      const Mean none = brightness(0);
      for (const int count : {1, 3}) {
        const Mean thinned = brightness(count);
        const double left = std::pow(1 - share, count);
        const double error = std::hypot(thinned.error(), left * none.error());
        CAPTURE(way.name, static_cast<int>(mis), count, thinned.mean(), left * none.mean(), error);
        CHECK(std::abs(thinned.mean() - left * none.mean()) < 5 * error);
        CHECK(error < 0.03 * none.mean());
      }
    }
}

TEST_CASE("the wavefront agrees with castRay where boxes are only partly there", "[statistical]") {
  const auto check = [](const std::string& name, const Scene& scene) {
    const Blocks expected = blocks_of(scene, reference_in_double(16), 24);
    RenderOptions options = wavefront_options(side, 8, 1);
    options.caustics = Switch::off;  // as castRay meets them: a mean of few samples is too dark as a rule
    const auto check_options = [&](const std::string& what, const RenderOptions& changed) {
      check_same_mean(name + ", " + what + ", shared", expected, blocks_of(scene, changed, 24));
      check_same_mean(name + ", " + what + ", plain", expected, blocks_of(scene, plain(changed), 24));
    };
    check_options("as planned", options);
    RenderOptions list = options, mis = options, cut = options, scalar = options;
    list.accel = AccelKind::list;
    check_options("list asked for", list);
    mis.mis = Switch::on;
    check_options("MIS", mis);
    cut.build = BuildQuality::best;  // rays may meet a triangle twice
    if (name == "diffuse") check_options("boxes cut", cut);
    scalar.isa = arithmetics().front();
    check_options(scalar.isa, scalar);
    check_same_bytes(scene, options);
  };
  check("diffuse", box_with("cornell_box", [](Material& m) { m.coverage = 0.6; }));
  check("metal", box_with("cornell_conductor", [](Material& m) { m.coverage = 0.5, m.alpha = 0.3; }));
  check("glass", box_with("cornell_conductor", [](Material& m) {
          m.type = MaterialType::dielectric, m.alpha = 0, m.coverage = 0.7;
        }));
}

TEST_CASE("two branches of plain paths have the mean of castRay", "[statistical]") {
  const Scene scene = standard_scene("kinds/foliage");
  RenderOptions reference = reference_in_double(8), options = wavefront_options(256, 4, 1);
  reference.width = reference.height = 256;
  reference.crop = options.crop = Window{.x0 = 100, .y0 = 84, .x1 = 124, .y1 = 108};
  REQUIRE_THAT(render(scene, options).film.key, Catch::Contains("; branches=2"));
  check_same_mean("branches", blocks_of(scene, reference, 24), blocks_of(scene, options, 24));
}

TEST_CASE("a pixel sees what is half there in half of its samples, not by chance") {
  SceneSketch sketch;
  const auto cloth = sketch.add_material({.name = "cloth", .kd = Vec3d(0.8), .coverage = 0.5});
  sketch.add_quad({-9, -9, 0}, {9, -9, 0}, {9, 9, 0}, {-9, 9, 0}, cloth);
  sketch.scene.environment = Vec3d(1);
  sketch.scene.camera = make_camera({0, 0, 3}, {}, {0, 1, 0}, 36);
  for (const bool shared : {true, false}) {
    RenderOptions options = wavefront_options(32, 16, 3);
    options.reuse.automatic = shared;
    Mean mean;
    for (const Vec3f& p : render(sketch.scene, options).film.image().pixels) mean.add(p.x);
    const double by_chance = 0.2 * 0.5 / std::sqrt(16);  // the sky is 1, the cloth 0.8
    CAPTURE(shared, mean.variance(), by_chance);
    CHECK(std::sqrt(mean.variance()) < 0.2 * by_chance);
  }
}

TEST_CASE("sheets thin the light of lamps, and add no noise") {
  for (const bool shared : {true, false}) {
    const auto noise = [&](int count) {
      RenderOptions options = wavefront_options(16, 16, 1);
      options.reuse.automatic = shared;
      options.reconstruct = Switch::off;  // which gains more where there are no sheets
      const Scene scene = sheets(count, 0.3);
      double square = 0, sum = 0;  // of differences, and of pixels
      for (options.seed = 0; options.seed < 8; options.seed += 2) {
        const Image a = render(scene, options).film.image();
        RenderOptions again = options;
        ++again.seed;
        const Image b = render(scene, again).film.image();
        for (std::size_t i = 0; i < a.pixels.size(); ++i) {
          square += std::pow(static_cast<double>(a.pixels[i].x - b.pixels[i].x), 2);
          sum += static_cast<double>(a.pixels[i].x);
        }
      }
      return std::sqrt(square) / sum;
    };
    const double none = noise(0), three = noise(3);
    CAPTURE(shared, none, three);
    CHECK(three < 1.3 * none);
  }
}

TEST_CASE("without jitter every sample meets its own holes", "[statistical]") {
  const Scene scene = box_with("cornell_box", [](Material& m) { m.coverage = 0.6; });
  RenderOptions reference = reference_in_double(16), options = wavefront_options(side, 8, 1);
  reference.jitter = options.jitter = false;
  check_same_mean("no jitter", blocks_of(scene, reference, 24), blocks_of(scene, options, 24));
}

TEST_CASE("masked leaves look like leaves cut from triangles", "[statistical]") {
  const Scene masked = leaves(150, true), cut = leaves(150, false);
  const Blocks expected = blocks_of(cut, wavefront_options(side, 16, 1), 24);
  check_same_bytes(masked, wavefront_options(side, 2, 1));
  for (const Way& way : every_way(wavefront_options(side, 16, 1), arithmetics()))
    check_same_mean(way.name, expected, blocks_of(masked, way.options, 24));
}

TEST_CASE("a lamp that is half there gives half its light", "[statistical]") {
  const auto room = [](bool masked) {
    Scene scene = sheets(0, 1);
    scene.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    for (std::size_t i = 0; i < scene.triangles.size(); ++i)
      scene.triangle_uvs.push_back(i % 2 ? Index3{0, 2, 3} : Index3{0, 1, 2});
    if (masked) {
      set_half_mask(scene, scene.materials[1]);
    } else {  // the right half of the lamp's first four corners, in the room's own triangles
      scene.positions[0].x = scene.positions[3].x = 0;
    }
    return scene;
  };
  const Blocks expected = blocks_of(room(false), wavefront_options(side, 16, 1), 24);
  check_same_bytes(room(true), wavefront_options(side, 2, 1));
  for (const Way& way : every_way(wavefront_options(side, 16, 1), arithmetics()))
    for (const Switch mis : {Switch::off, Switch::on}) {
      RenderOptions options = way.options;
      options.mis = mis;
      check_same_mean(way.name + ", mask", expected, blocks_of(room(true), options, 24));
    }
  Scene dim = sheets(0, 1), thin = sheets(0, 1);
  dim.materials[1].ke = dim.materials[1].ke * 0.5;
  thin.materials[1].coverage = 0.5;
  const Blocks half = blocks_of(dim, wavefront_options(side, 16, 1), 24);
  check_same_bytes(thin, wavefront_options(side, 2, 1));
  for (const Way& way : every_way(wavefront_options(side, 16, 1), arithmetics()))
    check_same_mean(way.name + ", share", half, blocks_of(thin, way.options, 24));
}

TEST_CASE("masks do not depend on threads, crops, sample ranges or the instruction set") {
  const Scene scene = leaves(150, true);
  RenderOptions options = wavefront_options(45, 4, 1);
  for (const bool shared : {true, false}) {
    options.reuse.automatic = shared;
    const Image image = render(scene, options).film.image();
    RenderOptions threads = options, crop = options;
    threads.threads = 3;
    CHECK(render(scene, threads).film.image().pixels == image.pixels);
    crop.crop = Window{45, 45, 10, 12, 33, 40};
    const Image part = render(scene, crop).film.image();
    for (int y = 12; y < 40; ++y)
      for (int x = 10; x < 33; ++x) REQUIRE(part.at(x - 10, y - 12) == image.at(x, y));
    for (const std::string& set : instruction_sets()) {
      if (set != "avx2" && set != "avx512") continue;
      RenderOptions other = options;
      other.isa = set;
      CHECK(render(scene, other).film.image().pixels == image.pixels);
    }
  }
}
