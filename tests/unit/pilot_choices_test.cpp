#include <catch2/catch.hpp>

#include "castray/render.h"
#include "test_scenes.h"

// What the pilot chooses for scenes.

using namespace castray;
using namespace castray::test;

TEST_CASE("an image with few suffixes by a pilot is that of as many given, and its film tells them") {
  const Scene floor = standard_scene("kinds/glossy_floor");
  RenderOptions options;
  options.width = options.height = 96;
  options.spp = 1;
  RenderOptions few = options;
  few.reuse = {.automatic = false, .width = 8, .height = 8, .suffixes = 32};
  const Film film = render(floor, options).film;
  CHECK_THAT(film.key, Catch::Contains("sharing=on; suffixes=32"));
  CHECK(describe(film).at("castray:suffixes") == "32");
  CHECK_THAT(describe(film).at("castray:options"), !Catch::Contains("--suffixes"));  // there is no such flag
  CHECK(film.image().pixels == render(floor, few).film.image().pixels);
}

TEST_CASE(
    "paths from lights bring the caustics of small lamps by default, and chance what black mirrors throw") {
  RenderOptions options;
  options.width = options.height = 64;
  options.spp = 1;
  for (const char* name : {"kinds/glass_ball_small_lamp", "kinds/smooth_glass_ball"})
    CHECK_THAT(render(standard_scene(name), options).film.key, Catch::Contains("; light-paths=on"));
  Scene scene = standard_scene("kinds/facing_mirrors");
  for (Material& m : scene.materials)
    if (m.type == MaterialType::conductor) m.reflectance = {1e-4, 1e-4, 1e-4};
  options.reuse = {.automatic = false};
  const Film film = render(scene, options).film;
  CHECK_THAT(film.key, !Catch::Contains("light-paths"));
  options.caustics = Switch::off;
  CHECK((render(scene, options).film.image().pixels == film.image().pixels));
}

TEST_CASE("whether an image is reconstructed is chosen alike for all parts of it, and never for few tiles") {
  RenderOptions options;
  options.width = options.height = 192;
  options.spp = 1;
  const auto kept = [](const Scene& scene, const RenderOptions& o) {
    const Film film = render(scene, o).film;
    CHECK(film.differences().kept() == (film.key.find("; differences=on") != std::string::npos));
    return film.differences().kept();
  };
  const Scene box = standard_scene("cornell_box"), outdoors = standard_scene("kinds/sky_and_ground");
  CHECK(kept(box, options));
  CHECK_FALSE(kept(outdoors, options));
  options.crop = Window{.x0 = 20, .y0 = 30, .x1 = 33, .y1 = 41};
  options.samples = SampleRange{5, 1};
  options.threads = 3;
  options.seed = 9;
  CHECK(kept(box, options));
  CHECK_FALSE(kept(outdoors, options));
  options.target_error = 0.1;
  options.samples.reset();
  CHECK_FALSE(kept(box, options));
  RenderOptions small;
  small.width = small.height = 32;
  small.spp = 4;
  CHECK_FALSE(kept(box, small));
}

TEST_CASE("under leaves paths are plain by default, in the box they are shared, whatever part is rendered") {
  RenderOptions options;
  options.width = options.height = 64;
  options.spp = 2;
  const auto pixels = [](const Scene& scene, const RenderOptions& o) {
    return render(scene, o).film.image().pixels;
  };
  RenderOptions plain = options, shared = options;
  plain.reuse = {.automatic = false};
  shared.reuse = {.automatic = false, .width = 8, .height = 8, .suffixes = 64};
  const Scene leaves = standard_scene("kinds/foliage"), box = standard_scene("cornell_box");
  CHECK(pixels(box, options) == pixels(box, shared));
  const RenderResult alone = render(leaves, options);
  CHECK_THAT(alone.film.key, Catch::Contains("sharing=off"));
  CHECK_THAT(render(box, options).film.key, Catch::Contains("sharing=on"));
  CHECK(alone.stats.pilot_seconds > 0);
  CHECK(alone.stats.render_seconds > alone.stats.pilot_seconds);
  CHECK(render(box, plain).stats.pilot_seconds == 0);  // there is nothing to choose
  RenderOptions part = options;
  part.crop = Window{.x0 = 20, .y0 = 30, .x1 = 33, .y1 = 41};
  part.samples = options.samples = SampleRange{5, 1};
  part.threads = 3;
  const Image whole = render(leaves, options).film.image(), crop = render(leaves, part).film.image();
  for (int y = 0; y < crop.height; ++y)
    for (int x = 0; x < crop.width; ++x) REQUIRE(crop.at(x, y) == whole.at(20 + x, 30 + y));
}

TEST_CASE("small images of matte scenes share their paths, though single samples show edges above all") {
  RenderOptions options;
  options.width = options.height = 96;
  options.spp = 1;
  for (const char* name : {"details/colours", "lights/point", "lights/spot"}) {
    const Scene scene = load_scene(std::string(CASTRAY_ROOT) + "/tests/golden/" + name + ".json");
    CAPTURE(name);
    CHECK_THAT(render(scene, options).film.key, Catch::Contains("sharing=on"));
  }
}
