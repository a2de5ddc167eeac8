#include <catch2/catch.hpp>

#include "box_scenes.h"
#include "castray_blocks.h"
#include "test_scenes.h"
#include "wavefront/wavefront.h"

using namespace castray;
using namespace castray::test;

// The wavefront integrator, in all its forms, against castRay in double precision.

TEST_CASE("the wavefront agrees with castRay on the standard scenes", "[statistical]") {
  for (const char* name : {"cornell_box", "cornell_conductor", "cornell_microfacet", "cornell_lights",
                           "cornell_obj", "one_triangle"})
    check_scene(name, standard_scene(name));
}

TEST_CASE("the wavefront agrees with castRay on every material", "[statistical]") {
  check_scene("narrow", box_with([](Material& m) { m.alpha = 0.05; }), 96);
  check_scene("rough glass", box_with([](Material& m) { m.type = MaterialType::dielectric, m.alpha = 0.4; }));
  check_scene("black", box_with([](Material& m) { m.type = MaterialType::diffuse, m.kd = Vec3d(0); }));
  check_scene("metal by its index, with multiple scattering", box_with([](Material& m) {
                m.type = MaterialType::conductor, m.alpha = 0.5, m.multiple_scattering = true;
                m.eta = {0.2, 0.9, 2.5}, m.k = {3.4, 1.5, 0.8};
              }));
  check_scene("principled", box_with([](Material& m) {
                m.type = MaterialType::principled, m.alpha = 0.3, m.metallic = 0.4;
                m.ks = Vec3d(0.04), m.sheen = 0.7, m.clearcoat = 0.8, m.clearcoat_roughness = 0.4;
              }));
}

TEST_CASE("mirrors and glass agree with castRay, whether their caustics come from lights or by chance",
          "[statistical]") {
  const auto check = [](const std::string& name, const std::function<void(Material&)>& change) {
    const Scene scene = with_larger_lamps(box_with(change), 3);
    const Expected expected(scene);
    for (const Switch caustics : {Switch::on, Switch::off})
      for (const AccelKind accel : {AccelKind::list, AccelKind::bvh}) {
        RenderOptions options = wavefront_options(8);
        options.caustics = caustics;
        options.accel = accel;
        options.reuse = {false, 8, 8, 64};
        const std::string what = name + (caustics == Switch::on ? ", lights" : ", chance") +
                                 (accel == AccelKind::list ? "" : ", tree");
        expected.check(what, scene, options);
        expected.check(what + ", plain", scene, plain(options));
      }
  };
  check("mirror", [](Material& m) { m.alpha = 0; });
  check("near mirror", [](Material& m) { m.alpha = 0.03; });
  check("principled metal", [](Material& m) {
    m.type = MaterialType::principled, m.kd = {.9, .6, .3}, m.metallic = 1, m.alpha = 0.05;
  });
  check("glass", [](Material& m) { m.type = MaterialType::dielectric, m.alpha = 0; });
  check("rough glass", [](Material& m) { m.type = MaterialType::dielectric, m.alpha = 0.2; });
  check("varnish", [](Material& m) {
    m.type = MaterialType::microfacet, m.alpha = 0, m.kd = {.6, .3, .1}, m.ks = {.05, .05, .05};
  });
}

namespace {

/// Mirrors, glass or polished metal in a box of smooth normals, far from the geometric ones everywhere.
Scene smooth_box(const std::function<void(Material&)>& change) {
  return with_detail(with_larger_lamps(box_with(change), 3), 1.5f);
}

/// The same with normals that all lean to one side: from behind them surfaces are seen as flat.
Scene leaning_box(const std::function<void(Material&)>& change) {
  Scene scene = with_detail(with_larger_lamps(box_with(change), 3), 4);
  for (std::size_t i = 0; i < scene.normals.size(); ++i) scene.normals[i] = scene.normals[i / 3 * 3];
  return scene;
}

/// The same with a bump map on every surface instead.
Scene bumpy_box(const std::function<void(Material&)>& change) {
  Scene scene = smooth_box(change);
  scene.normals.clear();
  scene.triangle_normals.clear();
  for (Material& m : scene.materials) {
    m.map(SurfaceParameter::bump).texture = 0;
    m.map(SurfaceParameter::bump).gain = 0.1f * static_cast<float>(scene.unit);
  }
  return scene;
}

void check_caustics(const std::string& name, const Scene& scene) {
  const Expected expected(scene);
  RenderOptions options = wavefront_options(8);
  options.caustics = Switch::on;
  options.reuse = {false, 8, 8, 64};
  expected.check(name, scene, options);
  expected.check(name + ", plain", scene, plain(options));
}

}  // namespace

TEST_CASE("paths from lights have castRay's mean on smooth and bent normals", "[statistical]") {
  const auto mirror = [](Material& m) { m.alpha = 0; };
  const auto glass = [](Material& m) { m.type = MaterialType::dielectric, m.alpha = 0; };
  check_caustics("smooth glass", smooth_box(glass));
  check_caustics("leaning mirror", leaning_box(mirror));
  check_caustics("leaning glass", leaning_box(glass));
  check_caustics("bumpy mirror", bumpy_box(mirror));
}

TEST_CASE("paths from lights have castRay's mean where surfaces have holes", "[statistical]") {
  Scene scene = with_larger_lamps(box_with([](Material& m) { m.alpha = 0; }), 3);
  for (Material& m : scene.materials)
    if (!m.emits()) m.coverage = 0.7;
  check_caustics("holes", scene);
}

TEST_CASE("paths from lights have castRay's mean where the camera sees a caustic's surface edge-on",
          "[statistical]") {
  const Scene scene = standard_scene("kinds/near_mirror");  // the cube's top is at the height of the camera
  RenderOptions options = wavefront_options(8);
  options.caustics = Switch::on;
  options.reuse = {false, 8, 8, 64};
  Expected(scene).check("cube seen edge-on", scene, options);
}

TEST_CASE("paths from lights have castRay's mean at each depth, with two sides and fixed roulette",
          "[statistical]") {
  Scene scene = with_larger_lamps(box_with([](Material& m) { m.alpha = 0; }), 3);
  for (Material& m : scene.materials) m.two_sided_emission = m.emits();
  RenderOptions options = wavefront_options(8);
  options.caustics = Switch::on;
  for (const int depth : {2, 3, 4}) {
    options.max_depth = depth;
    RenderOptions reference = options;
    reference.caustics = Switch::automatic;
    Expected(scene, reference).check("depth " + std::to_string(depth), scene, options);
  }
  options.max_depth = 0;
  options.rr = 0.7;
  Expected(scene).check("fixed roulette", scene, options);
}

namespace {

/// Over the pixels' mean squares, the sum of their variances over 8 seeds.
double relative_variance(const Scene& scene, RenderOptions options) {
  std::vector<Mean> pixels(side * side);
  for (options.seed = 0; options.seed < 8; ++options.seed) {
    const std::vector<Vec3f> image = render(scene, options).film.image().pixels;
    for (std::size_t i = 0; i < image.size(); ++i) pixels[i].add(luminance(Vec3d(image[i])));
  }
  double sum = 0;
  for (const Mean& pixel : pixels) sum += pixel.variance() / (pixel.mean() * pixel.mean() + 0.01);
  return sum;
}

}  // namespace

TEST_CASE("paths from lights take nine tenths of the relative variance of a lamp in a bulb",
          "[statistical]") {
  const Scene scene = standard_scene("kinds/lamp_in_bulb");
  RenderOptions by_light = wavefront_options(16), by_chance = by_light;
  by_light.caustics = Switch::on;
  by_chance.caustics = Switch::off;
  CHECK(relative_variance(scene, by_light) < 0.1 * relative_variance(scene, by_chance));
}

TEST_CASE("what polished metal and rough glass throw is found by paths from lights", "[statistical]") {
  for (const char* name : {"near_mirror", "rough_glass"}) {
    const Scene scene = standard_scene(std::string("kinds/") + name);
    RenderOptions by_light = wavefront_options(16);
    by_light.caustics = Switch::on;
    by_light.reuse = {false, 8, 8, 64};
    RenderOptions by_chance = by_light;
    by_chance.caustics = Switch::off;
    CAPTURE(name);
    CHECK(relative_variance(scene, by_light) < 0.7 * relative_variance(scene, by_chance));
  }
}

TEST_CASE("what mirrors show of each other's caustics is found by the images of lamps in them",
          "[statistical]") {
  const Scene scene = standard_scene("kinds/facing_mirrors");
  RenderOptions by_light = plain(wavefront_options(16));
  by_light.caustics = Switch::on;
  RenderOptions by_chance = by_light;
  by_chance.caustics = Switch::off;
  CHECK(relative_variance(scene, by_light) < 0.15 * relative_variance(scene, by_chance));
}

TEST_CASE("the wavefront agrees with castRay on textures, smooth normals and an environment",
          "[statistical]") {
  check_scene("diffuse detail", with_detail(standard_scene("cornell_box")));
  check_scene("microfacet detail", with_detail(standard_scene("cornell_microfacet")));
  Scene sky = standard_scene("cornell_conductor");
  sky.environment = {0.4, 0.6, 0.9};
  check_scene("sky", sky);
}

TEST_CASE("every form of the wavefront has the same mean", "[statistical]") {
  const Scene scene = standard_scene("cornell_conductor");
  const Expected expected(scene);
  const auto check = [&](const std::string& what, const std::function<void(RenderOptions&)>& change) {
    RenderOptions options = wavefront_options(4);
    change(options);
    expected.check(what, scene, options);
    expected.check(what + ", plain", scene, plain(options));
  };
  check("tree", [](RenderOptions& o) { o.accel = AccelKind::bvh; });
  check("tree, generic", [](RenderOptions& o) { o.accel = AccelKind::bvh, o.generic = true; });
  check("without fused operations", [](RenderOptions& o) { o.isa = arithmetics().front(); });
  check("MIS", [](RenderOptions& o) { o.mis = Switch::on; });
  check("independent numbers", [](RenderOptions& o) { o.sampler = SamplerKind::independent; });
  check("fixed roulette", [](RenderOptions& o) { o.rr = 0.7; });
  check("64 suffixes", [](RenderOptions& o) { o.reuse = {false, 8, 8, 64}; });
  check("4 suffixes", [](RenderOptions& o) { o.reuse = {false, 8, 8, 4}; });
}

namespace {

/// The box with 256 lights, away from the ceiling, of very different powers; some tilted, some two-sided.
Scene unequal_lights(Scene scene) {
  for (std::size_t i = 0; i < scene.lights.size(); ++i) {
    Material light = scene.material_of(scene.lights[i]);
    light.ke = light.ke * (i % 7 == 0 ? 3 : 0.5);
    light.two_sided_emission = i % 11 == 0;
    Index3& t = scene.triangles[scene.lights[i]];
    for (std::size_t k = 0; k < 3; ++k) {
      Vec3f corner = scene.positions[t[k]];
      corner.y -= i % 3 == 0 && k == 2 ? 0.35f : 0.3f;
      t[k] = static_cast<std::uint32_t>(scene.positions.size());
      scene.positions.push_back(corner);
    }
    scene.triangle_material[scene.lights[i]] = static_cast<std::uint16_t>(scene.materials.size());
    scene.materials.push_back(light);
  }
  return scene;
}

}  // namespace

TEST_CASE("every way of choosing light points has the same mean", "[statistical]") {
  const auto check = [](const std::string& name, const Scene& scene, const std::vector<Switch>& switches) {
    RenderOptions reference = wavefront_options(64);
    reference.mis = Switch::on;
    const Expected expected(scene, reference, 48);
    for (const LightSampling lights : {LightSampling::area, LightSampling::solid_angle, LightSampling::tree})
      for (const Switch mis : switches) {
        RenderOptions options = wavefront_options(16);
        options.lights = lights;
        options.mis = mis;
        const std::string what = name + ", " + std::to_string(static_cast<int>(lights));
        expected.check(what, scene, options);
        expected.check(what + ", plain", scene, plain(options));
      }
  };
  check("one light", standard_scene("cornell_box"), {Switch::on, Switch::off});
  check("many lights", standard_scene("cornell_lights"), {Switch::off});
  // Without MIS the following have rare bright samples, too few here for a z-test.
  check("unequal lights", unequal_lights(standard_scene("cornell_lights")), {Switch::on});
  check("metal", unequal_lights(box_with([](Material& m) { m.alpha = 0.4; })), {Switch::on});
  check("glass",
        unequal_lights(box_with([](Material& m) { m.type = MaterialType::dielectric, m.alpha = 0.4; })),
        {Switch::on});
}

TEST_CASE("where a camera ray misses nothing is lit, whatever the first triangle is made of") {
  Scene scene =
      unequal_lights(box_with([](Material& m) { m.type = MaterialType::dielectric, m.alpha = 0.4; }));
  for (Material& m : scene.materials) m.two_sided_emission = m.emits();
  const RenderResult result = render(scene, plain(wavefront_options(16)));
  CHECK(result.film.nonfinite_samples == 0);
  CHECK(result.film.image().pixels[0] == Vec3f());
}

TEST_CASE("without jitter the wavefront agrees with castRay too", "[statistical]") {
  for (const char* name : {"cornell_conductor", "cornell_lights"}) {
    const Scene scene = standard_scene(name);
    RenderOptions options = wavefront_options(4);
    options.jitter = false;
    const Expected expected(scene, options);
    expected.check(name, scene, options);
    expected.check(std::string(name) + ", plain", scene, plain(options));
  }
}

TEST_CASE("a limited depth means the same to the wavefront", "[statistical]") {
  const Scene scene = standard_scene("cornell_conductor");
  for (const int depth : {1, 2, 3, 4}) {
    RenderOptions options = wavefront_options(4);
    options.max_depth = depth;
    const Expected expected(scene, options);
    for (const Switch mis : {Switch::on, Switch::off}) {
      options.mis = mis;
      expected.check("depth " + std::to_string(depth), scene, options);
      expected.check("depth " + std::to_string(depth) + ", plain", scene, plain(options));
    }
  }
}

TEST_CASE("the furnace closes on the wavefront, with each technique on and off", "[statistical]") {
  const Scene scene = standard_scene("furnace");
  const Material& wall = scene.materials[0];
  for (const bool shared : {true, false})
    for (const Switch mis : {Switch::on, Switch::off})
      for (const SamplerKind sampler : {SamplerKind::sobol, SamplerKind::independent}) {
        RenderOptions options = wavefront_options(64);
        options.mis = mis;
        options.sampler = sampler;
        if (!shared) options = plain(options);
        Mean mean[3];
        for (std::uint64_t seed = 0; seed < 16; ++seed) {
          options.seed = seed;
          Vec3d sum;
          for (const Vec3f& p : render(scene, options).film.image().pixels) sum += Vec3d(p);
          for (int c = 0; c < 3; ++c) mean[c].add(sum[c] / (side * side));
        }
        for (int c = 0; c < 3; ++c) {
          CAPTURE(shared, static_cast<int>(mis), static_cast<int>(sampler), c, mean[c].error());
          CHECK(std::abs(mean[c].mean() - wall.ke[c] / (1 - wall.kd[c])) < 4.5 * mean[c].error() + 1e-6);
        }
      }
}

// Triangles of a pixel or two: what widens the pyramids over them must be much less than they are.
TEST_CASE("on fine meshes shared paths find the light that plain ones find", "[statistical]") {
  for (const std::uint32_t frequency : {16u, 60u}) {
    const Scene scene = box_with_mesh(frequency, 180, {278, 182, 280});
    RenderOptions options = wavefront_options(4);
    options.width = options.height = 512;
    options.crop = Window{512, 512, 240, 240, 240 + side, 240 + side};  // on the ball
    RenderOptions many = plain(options);
    many.spp = 256;
    many.sampler = SamplerKind::independent;
    Expected(blocks_of(scene, many, 24)).check("frequency " + std::to_string(frequency), scene, options, 96);
  }
}

namespace {

/// A ball of a hundredth of the scene's size under a lamp.
Scene small_ball(std::uint32_t frequency) {
  SceneSketch sketch;
  const auto white = sketch.add_material({.name = "white", .kd = Vec3d(0.8)});
  const auto lamp = sketch.add_material({.name = "lamp", .kd = {}, .ke = Vec3d(1)});
  sketch.add_quad({-1, 1, -1}, {1, 1, -1}, {1, 1, 1}, {-1, 1, 1}, lamp);
  sketch.add_quad({-1, -1, 1}, {1, -1, 1}, {1, -1, -1}, {-1, -1, -1}, white);
  const Shape ball = icosphere(frequency);
  sketch.add_mesh(ball.positions, ball.triangles, 0.01, {}, false, white);
  sketch.scene.camera = make_camera({0.04, 0.06, 0.08}, {}, {0, 1, 0}, 12);
  return sketch.scene;
}

}  // namespace

// Found from afar, its triangles are off by as much as its points are off them: with 1280 triangles by
// shafts, with 20480 by rays.
TEST_CASE("a small mesh does not hide its own points from what lights a tile", "[statistical]") {
  for (const std::uint32_t frequency : {8u, 32u}) {
    const Scene scene = small_ball(frequency);
    const Expected expected(scene);
    for (const Switch mis : {Switch::on, Switch::off}) {
      RenderOptions options = wavefront_options(4);
      options.mis = mis;
      expected.check("shared, " + std::to_string(frequency), scene, options, 96);
      expected.check("plain, " + std::to_string(frequency), scene, plain(options), 96);
    }
  }
}

TEST_CASE("a shared render has no bias that many seeds would show", "[statistical][long]") {
  for (const char* name : {"cornell_box", "cornell_conductor", "cornell_microfacet", "cornell_lights"}) {
    const Scene scene = standard_scene(name);
    Expected(scene, wavefront_options(256), 64).check(name, scene, wavefront_options(16), 512);
  }
}

TEST_CASE("shared and plain renders have one mean in every 16x16 block, over many seeds",
          "[statistical][long]") {
  constexpr std::uint64_t seeds = 256;
  const std::pair<const char*, Scene> scenes[] = {{"cornell_box", standard_scene("cornell_box")},
                                                  {"cornell_conductor", standard_scene("cornell_conductor")},
                                                  {"mesh", box_with_mesh()}};
  for (const auto& [name, scene] : scenes) {
    const auto renders_of = [&scene = scene](RenderOptions options) {
      options.width = options.height = 128;
      Blocks renders;
      for (std::uint64_t seed = 0; seed < seeds; ++seed, ++options.seed)
        renders.push_back(block_means(render(scene, options).film.image(), 16));
      return renders;
    };
    const Expected expected(renders_of(plain(wavefront_options(32, 1))));
    const BlockScores scores =
        block_scores(renders_of(wavefront_options(16, 1 + seeds)), expected.mean, expected.variance);
    CAPTURE(name, scores.rms, scores.largest, scores.count);
    CHECK(scores.largest < 4);  // of 192 scores, a false alarm for one scene of 80
    CHECK(scores.rms < 1.25);   // 1 has a standard error of 0.05
    CHECK(scores.rms > 0.75);
  }
}
