#include <catch2/catch.hpp>

#include "test_scenes.h"

using namespace castray;
using namespace castray::test;

// --clamp-indirect: off by default; bounds what a sample's first bounce brings, and nothing else.

namespace {

/// One sample of each pixel.
Image samples(const Scene& scene, RenderOptions options, std::optional<double> clamp, int max_depth = 0) {
  options.width = options.height = 48;
  options.spp = 1;
  options.clamp_indirect = clamp;
  options.max_depth = max_depth;
  return render(scene, options).film.image();
}

Vec3f clamped(const Vec3f& direct, const Vec3f& whole, float most) {
  const Vec3f indirect = whole - direct;
  const float brightest = max_component(indirect);
  return brightest > most ? direct + indirect * (most / brightest) : whole;
}

void check_clamp(const RenderOptions& options) {
  constexpr float most = 0.1f;
  const Scene scene = standard_scene("cornell_box");
  const Image whole = samples(scene, options, {}), direct = samples(scene, options, {}, 2),
              bounded = samples(scene, options, most);
  CHECK(samples(scene, options, 1e30).pixels == whole.pixels);
  int changed = 0;
  for (std::size_t i = 0; i < whole.pixels.size(); ++i) {
    const Vec3f expected = clamped(direct.pixels[i], whole.pixels[i], most);
    for (int c = 0; c < 3; ++c) CHECK(bounded.pixels[i][c] == Approx(expected[c]).margin(1e-5));
    changed += bounded.pixels[i] != whole.pixels[i];
  }
  CHECK(changed > 400);
  CHECK(changed < 48 * 48);
}

}  // namespace

TEST_CASE("clamp-indirect bounds what the first bounce brings, on the reference") {
  check_clamp(reference_options(48, 48, 1));
}

TEST_CASE("clamp-indirect bounds what the first bounce brings, on the wavefront") {
  RenderOptions options;
  SECTION("shared paths") {}
  SECTION("plain paths") { options.reuse = {.automatic = false}; }
  SECTION("tree") { options.accel = AccelKind::bvh; }
  SECTION("every material") { options.generic = true; }
  check_clamp(options);
}
