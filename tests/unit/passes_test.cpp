// Passes of what the camera's rays meet, against values found by hand.
#include <catch2/catch.hpp>

#include <bit>
#include <cmath>

#include "box_scenes.h"
#include "castray/passes.h"
#include "instanced.h"
#include "passes/cryptomatte.h"
#include "passes/murmur3.h"

using namespace castray;
using castray::test::SceneSketch;

namespace {

constexpr int side = 8;
constexpr Vec3d grey{0.2, 0.4, 0.6}, gold{0.9, 0.7, 0.3};

PassSet set_of(std::initializer_list<Pass> passes) {
  PassSet set;
  for (const Pass pass : passes) set.add(pass);
  return set;
}

Passes render(const Scene& scene, std::initializer_list<Pass> passes, const RenderOptions& options) {
  return render_passes(scene, options, set_of(passes)).value();
}

RenderOptions options_of(std::uint64_t spp = 16) { return castray::test::wavefront_options(side, spp, 1); }

const std::vector<float>& channel(const Passes& passes, const std::string& name) {
  for (const ImageChannel& c : passes.channels)
    if (c.name == name) return c.values;
  FAIL("no channel " << name);
  throw 0;
}

float id_of(const std::string& name) { return std::bit_cast<float>(matte_id(name)); }

/// A camera at the origin that looks along +z; its image's right is -x.
Scene looking_along_z(SceneSketch sketch) {
  Scene scene = std::move(sketch.scene);
  scene.camera = make_camera({0, 0, 0}, {0, 0, 1}, {0, 1, 0}, 90);
  scene.width = scene.height = side;
  return scene;
}

/// The plane z = 0.5 + slope x, over x0 <= x <= x1, named "plane".
Scene plane(float slope, float x0, float x1, const Material& material) {
  SceneSketch sketch;
  const std::uint16_t m = sketch.add_material(material);
  sketch.add_quad({x1, -1, 0.5f + slope * x1}, {x0, -1, 0.5f + slope * x0}, {x0, 1, 0.5f + slope * x0},
                  {x1, 1, 0.5f + slope * x1}, m);
  sketch.scene.objects = {{"plane", 0}};
  return looking_along_z(std::move(sketch));
}

Material diffuse(const Vec3d& kd) {
  Material m;
  m.name = "paint";
  m.kd = kd;
  return m;
}

}  // namespace

TEST_CASE("MurmurHash3_32 gives its published values") {
  CHECK(murmur3_32("") == 0);
  CHECK(murmur3_32("a") == 0x3c2569b2u);
  CHECK(murmur3_32("abc") == 0xb3dd93fau);
  CHECK(murmur3_32("hello") == 0x248bfa47u);
  CHECK(murmur3_32("hello, world") == 0x149bbb7fu);
  CHECK(murmur3_32("The quick brown fox jumps over the lazy dog") == 0x2e4ff723u);
}

TEST_CASE("ids of Cryptomatte are normal floats") {
  for (int i = 0; i < 4000; ++i) {
    const std::string name = "thing " + std::to_string(i);
    const std::uint32_t hash = murmur3_32(name), exponent = hash >> 23 & 255;
    CHECK(std::isnormal(std::bit_cast<float>(matte_id(name))));
    CHECK(matte_id(name) == (exponent == 0 || exponent == 255 ? hash ^ 0x800000u : hash));
  }
}

TEST_CASE("a plane across the view has its depth, normal, colour and position in every pixel") {
  Scene scene = plane(0, -1, 1, diffuse(grey));
  scene.center = {10, 20, 30};
  scene.unit = 4;
  const Passes passes =
      render(scene, {Pass::albedo, Pass::normal, Pass::depth, Pass::position, Pass::material, Pass::object},
             options_of());
  for (std::size_t i = 0; i < side * side; ++i) {
    CHECK(channel(passes, "Z")[i] == Approx(0.5 * 4));
    CHECK(channel(passes, "N.X")[i] == Approx(0).margin(1e-6));
    CHECK(channel(passes, "N.Y")[i] == Approx(0).margin(1e-6));
    CHECK(channel(passes, "N.Z")[i] == Approx(-1));
    CHECK(channel(passes, "albedo.R")[i] == Approx(grey.x));
    CHECK(channel(passes, "albedo.G")[i] == Approx(grey.y));
    CHECK(channel(passes, "albedo.B")[i] == Approx(grey.z));
    CHECK(channel(passes, "P.Z")[i] == Approx(30 + 0.5 * 4));
    // x of the pixel's middle on the plane, from +0.5 on the left to -0.5 on the right, within the jitter
    const double x = 0.5 - (static_cast<double>(i % side) + 0.5) / side;
    CHECK(channel(passes, "P.X")[i] == Approx(10 + 4 * x).margin(4 * 0.3 / side));
    CHECK(channel(passes, "CryptoObject00.R")[i] == id_of("plane"));
    CHECK(channel(passes, "CryptoObject00.G")[i] == 1);
    CHECK(channel(passes, "CryptoMaterial00.R")[i] == id_of("paint"));
    CHECK(channel(passes, "CryptoObject00.A")[i] == 0);
  }
}

TEST_CASE("a tilted plane has its normal and, in each pixel, the depth of its middle") {
  const Passes passes =
      render(plane(0.5f, -1, 1, diffuse(grey)), {Pass::normal, Pass::depth, Pass::position}, options_of(64));
  const Vec3d normal = normalize(Vec3d(0.5, 0, -1));
  for (std::size_t i = 0; i < side * side; ++i) {
    CHECK(channel(passes, "N.X")[i] == Approx(normal.x));
    CHECK(channel(passes, "N.Z")[i] == Approx(normal.z));
    const double x = channel(passes, "P.X")[i];
    CHECK(channel(passes, "Z")[i] == Approx(0.5 + 0.5 * x));
    CHECK(channel(passes, "P.Z")[i] == Approx(channel(passes, "Z")[i]));
    const double tangent = 1 - (2 * static_cast<double>(i % side) + 1) / side;  // x / z of the pixel's middle
    CHECK(x == Approx(0.5 * tangent / (1 - 0.5 * tangent)).margin(0.01));
  }
}

TEST_CASE("the sky counts as black and as no object, depth and position are those of what is hit") {
  // The plane covers x >= 0: half of the image, and half of no pixel but by the jitter within it.
  const Scene scene = plane(0, 0.0625f, 1, diffuse(grey));
  const Passes passes =
      render(scene, {Pass::albedo, Pass::normal, Pass::depth, Pass::object}, options_of(64));
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      // The plane's edge is where the image's tangent is 0.125: in the middle of column 3's right half.
      const double covered = x < 3 ? 1 : x == 3 ? 0.5 : 0;
      const auto i = static_cast<std::size_t>(y * side + x);
      CHECK(channel(passes, "CryptoObject00.G")[i] == Approx(covered).margin(1. / 64));
      CHECK(channel(passes, "albedo.G")[i] ==
            Approx(grey.y * static_cast<double>(channel(passes, "CryptoObject00.G")[i])).margin(1e-6));
      CHECK(channel(passes, "N.Z")[i] == Approx(-channel(passes, "CryptoObject00.G")[i]));
      CHECK(channel(passes, "Z")[i] == Approx(covered > 0 ? 0.5 : 0));
      CHECK((channel(passes, "CryptoObject00.R")[i] == id_of("plane")) == (covered > 0));
    }
}

TEST_CASE("what is only partly there covers its share, and shows what is behind it") {
  Material leaf = diffuse(gold);
  leaf.name = "leaf";
  leaf.coverage = 0.25;
  SceneSketch sketch;
  const std::uint16_t front = sketch.add_material(leaf), back = sketch.add_material(diffuse(grey));
  sketch.add_quad({1, -1, .25f}, {-1, -1, .25f}, {-1, 1, .25f}, {1, 1, .25f}, front);
  sketch.add_quad({1, -1, .5f}, {-1, -1, .5f}, {-1, 1, .5f}, {1, 1, .5f}, back);
  sketch.scene.objects = {{"leaf", 0}, {"wall", 2}};
  const Passes passes =
      render(looking_along_z(std::move(sketch)), {Pass::albedo, Pass::object}, options_of(64));
  double sum = 0;
  for (std::size_t i = 0; i < side * side; ++i) {
    // ranks by coverage: the wall first, in all but few pixels
    const bool wall_first = channel(passes, "CryptoObject00.R")[i] == id_of("wall");
    const float leaf_share = channel(passes, wall_first ? "CryptoObject00.A" : "CryptoObject00.G")[i];
    const float wall_share = channel(passes, wall_first ? "CryptoObject00.G" : "CryptoObject00.A")[i];
    CHECK(leaf_share + wall_share == Approx(1));
    CHECK((wall_share >= leaf_share) == wall_first);
    CHECK(channel(passes, "albedo.R")[i] ==
          Approx(gold.x * double{leaf_share} + grey.x * double{wall_share}));
    sum += leaf_share;
  }
  // 4096 trials of probability 1/4: 5 standard deviations, false alarms 6e-7
  CHECK(sum / (side * side) == Approx(0.25).margin(5 * std::sqrt(0.25 * 0.75 / 4096)));
}

TEST_CASE("instances have the passes of the same surfaces in scene space") {
  Material leaf = diffuse(gold);
  leaf.coverage = 0;  // nothing is seen of it
  SceneSketch sketch;
  const std::uint16_t front = sketch.add_material(leaf), ball = sketch.add_material(diffuse(grey));
  sketch.add_quad({1, -1, .1f}, {-1, -1, .1f}, {-1, 1, .1f}, {1, 1, .1f}, front);
  const castray::Shape shape = castray::icosphere(4);
  sketch.add_mesh(shape.positions, shape.triangles, 0.3, {0.1, 0, 0.6}, false, ball);
  const Scene flat = castray::test::with_detail(looking_along_z(std::move(sketch)));
  const std::initializer_list<Pass> set = {Pass::albedo, Pass::normal, Pass::depth, Pass::position};
  const Passes expected = render(flat, set, options_of());
  for (const Transform& place : castray::kinds_of_places()) {
    const Passes found = render(castray::as_instances(flat, {place}), set, options_of());
    REQUIRE(found.channels.size() == expected.channels.size());
    for (std::size_t c = 0; c < found.channels.size(); ++c)
      for (std::size_t i = 0; i < side * side; ++i)
        CHECK(found.channels[c].values[i] == Approx(expected.channels[c].values[i]).margin(1e-5));
  }
}

TEST_CASE("of seven things in a pixel the six that cover most have ranks, in their order") {
  Cryptomatte matte("Crypto", {"a", "b", "c", "d", "e", "f", "g", "b"}, 1);
  Cryptomatte::Counts counts;
  for (std::size_t thing = 0; thing < 8; ++thing) counts.add(thing, static_cast<std::uint32_t>(thing + 1));
  matte.set(0, counts, 64);
  Passes passes;
  std::move(matte).add_to(passes);
  REQUIRE(passes.channels.size() == 2 * Cryptomatte::ranks);
  // b is there twice: 2 + 8 samples
  const std::pair<std::string, float> ranks[] = {{"b", 10}, {"g", 7}, {"f", 6}, {"e", 5}, {"d", 4}, {"c", 3}};
  for (std::size_t rank = 0; rank < Cryptomatte::ranks; ++rank) {
    CHECK(passes.channels[2 * rank].values[0] == id_of(ranks[rank].first));
    CHECK(passes.channels[2 * rank + 1].values[0] == ranks[rank].second / 64);
  }
}

TEST_CASE("passes for denoisers look behind mirrors, tinted by them") {
  Material mirror;
  mirror.type = MaterialType::conductor;
  mirror.reflectance = gold;
  SceneSketch sketch;
  const std::uint16_t glass = sketch.add_material(mirror), wall = sketch.add_material(diffuse(grey));
  sketch.add_quad({1, -1, 1.5f}, {-1, -1, -.5f}, {-1, 1, -.5f}, {1, 1, 1.5f}, glass);  // z = 0.5 + x
  sketch.add_quad({.9f, -4, -4}, {.9f, -4, 4}, {.9f, 4, 4}, {.9f, 4, -4}, wall);       // x = 0.9
  sketch.scene.objects = {{"mirror", 0}, {"wall", 2}};
  const Scene scene = looking_along_z(std::move(sketch));
  RenderOptions options = options_of();
  options.crop = Window{side, side, 4, 3, 5, 5};
  const Passes passes = render(scene, {Pass::albedo, Pass::normal, Pass::denoising}, options);
  const auto near = [](double v) { return Approx(v).margin(1e-6); };
  for (std::size_t i = 0; i < 2; ++i) {
    CHECK(channel(passes, "albedo.R")[i] == near(gold.x));
    CHECK(channel(passes, "N.X")[i] == near(std::sqrt(0.5)));
    CHECK(channel(passes, "N.Z")[i] == near(-std::sqrt(0.5)));
    CHECK(std::abs(channel(passes, "denoising_normal.X")[i]) == near(1));
    CHECK(channel(passes, "denoising_albedo.R")[i] == near(gold.x * grey.x));
    CHECK(channel(passes, "denoising_albedo.B")[i] == near(gold.z * grey.z));
  }
}

TEST_CASE("a crop, other sample ranges and other threads do not change a pixel's passes") {
  const Scene scene = castray::test::standard_scene("cornell_obj");
  const auto all = {Pass::albedo, Pass::normal, Pass::depth, Pass::position, Pass::denoising, Pass::object};
  const Passes whole = render(scene, all, options_of());
  RenderOptions options = options_of();
  options.crop = Window{side, side, 2, 3, 7, 6};
  options.samples = SampleRange{5, 2};
  options.threads = 3;
  const Passes part = render(scene, all, options);
  REQUIRE(part.channels.size() == whole.channels.size());
  for (std::size_t c = 0; c < part.channels.size(); ++c)
    for (int y = 3; y < 6; ++y)
      for (int x = 2; x < 7; ++x)
        CHECK(part.channels[c].values[static_cast<std::size_t>((y - 3) * 5 + x - 2)] ==
              whole.channels[c].values[static_cast<std::size_t>(y * side + x)]);
}

TEST_CASE("passes stop when they are told to") {
  const Scene scene = plane(0, -1, 1, diffuse(grey));
  CHECK_FALSE(render_passes(scene, options_of(), set_of({Pass::albedo}), [] { return false; }));
}
