#include <catch2/catch.hpp>

#include <stdexcept>
#include <thread>

#include "castray/error.h"
#include "film_bytes.h"
#include "materials/texture.h"
#include "test_scenes.h"

using namespace castray;
using namespace castray::test;
using Catch::Contains;

// A scene made ready once gives the films that each render by itself would.

namespace {

RenderOptions options_of(Integrator integrator) {
  RenderOptions options;
  options.width = options.height = 24;
  options.spp = 3;
  options.integrator = integrator;
  return options;
}

}  // namespace

TEST_CASE("a prepared scene renders any samples, seed and window as if each were the first") {
  const Scene scene = standard_scene("cornell_microfacet");
  for (const Integrator integrator : {Integrator::wavefront, Integrator::reference})
    for (const AccelKind accel : {AccelKind::list, AccelKind::bvh}) {
      RenderOptions options = options_of(integrator);
      options.accel = accel;
      const PreparedScene prepared(scene, options);
      const auto same = [&](auto change) {
        RenderOptions now = options;
        change(now);
        CHECK(bytes(render(prepared, now).film) == bytes(render(scene, now).film));
      };
      same([](RenderOptions&) {});
      same([](RenderOptions& o) { o.seed = 7; });
      same([](RenderOptions& o) { o.samples = SampleRange{5, 2}; });
      same([](RenderOptions& o) { o.crop = Window{0, 0, 3, 5, 20, 11}; });
      same([](RenderOptions& o) { o.jitter = false; });
      same([](RenderOptions& o) { o.sampler = SamplerKind::independent; });
      same([](RenderOptions& o) { o.threads = 3; });
      same([](RenderOptions&) {});
    }
}

TEST_CASE("threads may render a prepared scene at the same time") {
  const Scene scene = standard_scene("cornell_box");
  for (const Integrator integrator : {Integrator::wavefront, Integrator::reference}) {
    const RenderOptions options = options_of(integrator);
    const PreparedScene prepared(scene, options);
    std::string films[3];
    std::vector<std::thread> threads;
    for (std::string& film : films)
      threads.emplace_back([&] { film = bytes(render(prepared, options).film); });
    for (std::thread& thread : threads) thread.join();
    CHECK(films[0] == films[1]);
    CHECK(films[0] == films[2]);
    CHECK(films[0] == bytes(render(scene, options).film));
  }
}

TEST_CASE("replicates and a target error use the tree that is there") {
  const Scene scene = standard_scene("cornell_box");
  RenderOptions options = options_of(Integrator::wavefront);
  options.accel = AccelKind::bvh;
  options.spp = 16;
  const PreparedScene prepared(scene, options);
  const double built = render(prepared, options).stats.bvh_seconds;
  CHECK(render_replicates(prepared, options, 8).stats.bvh_seconds == built);
  CHECK(bytes(render_replicates(prepared, options, 8).film) ==
        bytes(render_replicates(scene, options, 8).film));
  options.target_error = 0.1;
  CHECK(render(prepared, options).stats.bvh_seconds == built);
}

TEST_CASE("options that a scene was not prepared for are refused by name") {
  const Scene scene = standard_scene("cornell_box");
  const RenderOptions options = options_of(Integrator::automatic);
  const PreparedScene prepared(scene, options);
  const auto refused = [&](auto change, const char* name) {
    RenderOptions other = options;
    change(other);
    CHECK_THROWS_WITH(render(prepared, other), Contains(name) && Contains("prepare it anew"));
  };
  refused([](RenderOptions& o) { o.width = 25; }, "--size");
  refused([](RenderOptions& o) { o.integrator = Integrator::reference; }, "--integrator");
  refused([](RenderOptions& o) { o.epsilon = 1e-3; }, "--integrator");
  refused([](RenderOptions& o) { o.lights = LightSampling::area; }, "--lights");
  refused([](RenderOptions& o) { o.mis = Switch::on; }, "--mis");
  refused([](RenderOptions& o) { o.max_depth = 2; }, "--max-depth");
  refused([](RenderOptions& o) { o.isa = "other"; }, "--isa");
  refused([](RenderOptions& o) { o.accel = AccelKind::bvh; }, "--accel");
  refused([](RenderOptions& o) { o.build = BuildQuality::best; }, "--build");
  refused([](RenderOptions& o) { o.generic = true; }, "--generic");
  refused([](RenderOptions& o) { o.reuse = {.automatic = false}; }, "--reuse");
  const PreparedScene exact(scene, options_of(Integrator::reference));
  RenderOptions wide = options_of(Integrator::reference);
  wide.precision = Precision::float64;
  CHECK_THROWS_WITH(render(exact, wide), Contains("--precision"));
}

TEST_CASE("another view of a prepared scene is the image of a scene prepared for it, in any size") {
  for (const char* name : {"cornell_box", "cornell_conductor"}) {
    const Scene scene = standard_scene(name);
    for (const AccelKind accel : {AccelKind::list, AccelKind::bvh}) {
      RenderOptions options = options_of(Integrator::wavefront);
      options.accel = accel;
      options.reuse = {.automatic = false, .width = 8, .height = 8, .suffixes = 16};  // as no pilot decides
      options.caustics = Switch::off;
      const PreparedScene prepared(scene, options);
      Scene turned = scene;
      turned.camera = make_camera({0.3, 0.2, -1.5}, {0, -0.1, 0}, {0, 1, 0}, 50);
      options.width = 20, options.height = 30;
      const Image expected = render(turned, options).film.image();
      options.camera = turned.camera;
      const Film film = render(prepared, options).film;
      CHECK(film.image().pixels == expected.pixels);
      CHECK_THAT(film.key, Contains("; view="));
      CHECK(film.difference_from(render(turned, options).film).empty() == false);
    }
  }
  RenderOptions reference = options_of(Integrator::reference);
  const Scene scene = standard_scene("cornell_box");
  const PreparedScene prepared(scene, reference);
  reference.camera = scene.camera;
  CHECK_THROWS_WITH(render(prepared, reference), Contains("no other view"));
}

TEST_CASE("the film of a part of the window goes on as a crop does") {
  for (const char* name : {"cornell_box", "cornell_conductor"})
    for (const Switch reconstruct : {Switch::off, Switch::on}) {
      const Scene scene = standard_scene(name);
      RenderOptions options = options_of(Integrator::wavefront);
      options.reconstruct = reconstruct;
      const PreparedScene prepared(scene, options);
      const Film whole = render(prepared, options).film;
      options.crop = Window{0, 0, 3, 5, 20, 11};
      const Film part = whole.part({24, 24, 3, 5, 20, 11});
      CHECK(bytes(part) == bytes(render(prepared, options).film));
      options.spp = 7;
      CHECK(bytes(render(prepared, options, {}, &part).film) == bytes(render(prepared, options).film));
    }
}

TEST_CASE("a film's scale bounds what an image makes of an emission") {
  SceneSketch sketch;
  sketch.add_quad({-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0},
                  sketch.add_material({.name = "m", .ke = {3, 2, 1}}));
  Scene& scene = sketch.scene;
  const auto scale = [&] { return render(scene, options_of(Integrator::wavefront)).film.scale(); };
  CHECK(scale() == 4);
  scene.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  scene.triangle_uvs = {{0, 1, 2}, {0, 2, 3}};
  Image image(1, 1);
  image.at(0, 0) = {0.1f, 10, 0};
  scene.textures.push_back(make_texture("t", image));
  TextureMap& map = scene.materials[0].map(SurfaceParameter::ke);
  map.texture = 0;
  CHECK(scale() == 32);
  map.gain = 100, map.base = 5;
  CHECK(scale() == 4096);
  map.gain = -1, map.base = 0;
  CHECK(scale() == 4);
}

TEST_CASE("what a progress callback throws is thrown by render") {
  const Scene scene = standard_scene("cornell_box");
  for (const Integrator integrator : {Integrator::wavefront, Integrator::reference})
    for (const int threads : {1, 4})
      for (const bool in_a_pass : {true, false}) {  // told by a thread at work, or between passes
        RenderOptions options = options_of(integrator);
        options.width = options.height = 256;
        options.spp = 1u << 20;  // never reached
        options.threads = threads;
        CHECK_THROWS_WITH(render(scene, options,
                                 [&](const Progress& progress) -> bool {
                                   if ((progress.film == nullptr) == in_a_pass)
                                     throw std::runtime_error("no more");
                                   return true;
                                 }),
                          "no more");
      }
}

TEST_CASE("an absolute epsilon is the reference's, in the key too, what contradicts it is named") {
  const Scene scene = standard_scene("cornell_box");
  RenderOptions options = options_of(Integrator::automatic);
  CHECK_THAT(render(scene, options).film.key, Contains("integrator=wavefront"));
  options.epsilon = 1e-3;
  const RenderResult result = render(scene, options);
  CHECK_THAT(result.film.key, Contains("integrator=reference"));
  CHECK(result.stats.isa == "none");
  options.integrator = Integrator::wavefront;
  CHECK_THROWS_WITH(render(scene, options), Contains("--epsilon 0.001") && Contains("--integrator"));
  options.integrator = Integrator::automatic;
  options.isa = "avx2";
  CHECK_THROWS_WITH(render(scene, options), Contains("--epsilon 0.001") && Contains("--isa avx2"));
}

TEST_CASE("a film's key tells apart whatever the samples depend on") {
  Scene scene = standard_scene("cornell_microfacet");
  const RenderOptions options = options_of(Integrator::reference);
  const std::string key = render(scene, options).film.key;
  for (Material& material : scene.materials) material.correlated_masking = false;
  CHECK(render(scene, options).film.key != key);
}

TEST_CASE("a scene's name cannot pose as options of its film") {
  Scene scene = standard_scene("cornell_box");
  scene.name = "m; seed=7; clamp-indirect=1 50%\n";
  const Film film = render(scene, options_of(Integrator::automatic)).film;
  const Metadata metadata = describe(film);
  CHECK(metadata.at("castray:scene") == scene.name);
  CHECK(metadata.at("castray:seed") == "0");
  CHECK_FALSE(metadata.contains("castray:biased"));
  CHECK(film.key.find('\n') == std::string::npos);
}
