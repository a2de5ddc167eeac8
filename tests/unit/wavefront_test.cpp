#include <catch2/catch.hpp>

#include "box_scenes.h"
#include "core/sequences.h"
#include "film_bytes.h"
#include "integrators.h"
#include "test_scenes.h"
#include "wavefront/choose_kernel.h"

using namespace castray;
using namespace castray::test;

namespace {

RenderOptions small(const std::string& isa) {
  RenderOptions options;
  options.width = 45;
  options.height = 37;
  options.spp = 4;
  options.isa = isa;
  return options;
}

std::vector<Vec3f> pixels(const Scene& scene, const RenderOptions& options) {
  return render(scene, options).film.image().pixels;
}

/// How far the light of a render over a list is from that over a tree, relative to it. Both draw the same
/// numbers: only where roundings part their paths do they differ.
double list_from_tree(const Scene& scene, std::uint64_t spp) {
  RenderOptions options = small("auto");
  options.spp = spp;
  options.reconstruct = Switch::off;
  options.accel = AccelKind::list;
  const std::vector<Vec3f> list = pixels(scene, options);
  options.accel = AccelKind::bvh;
  const std::vector<Vec3f> tree = pixels(scene, options);
  double difference = 0, sum = 0;
  for (std::size_t i = 0; i < list.size(); ++i) {
    difference += luminance(list[i] - tree[i]);
    sum += luminance(tree[i]);
  }
  return std::abs(difference) / sum;
}

/// Threads, sample ranges and a crop give the samples of the whole film.
void check_parts(const Scene& scene, RenderOptions options, const Film& whole) {
  options.threads = 3;
  CHECK(bytes(render(scene, options).film) == bytes(whole));

  options.samples = SampleRange{3, 1};
  Film merged = render(scene, options).film;
  options.samples = SampleRange{0, 3};
  merged.merge(render(scene, options).film);
  CHECK(bytes(merged) == bytes(whole));

  options.samples.reset();
  options.crop = Window{0, 0, 11, 6, 30, 29};
  const Film crop = render(scene, options).film;
  for (int y = 6; y < 29; ++y)
    for (int x = 11; x < 30; ++x) REQUIRE(crop.mean(x, y) == whole.mean(x, y));
}

}  // namespace

TEST_CASE("instruction sets with fused multiply-add give the same bytes") {
  for (const char* name :
       {"cornell_box", "cornell_conductor", "cornell_microfacet", "cornell_lights", "furnace"})
    for (const bool shared : {true, false}) {
      const Scene scene = standard_scene(name);
      std::vector<std::vector<Vec3f>> images, images_by_angle;
      for (const std::string& set : instruction_sets()) {
        if (!has_fma(set)) continue;
        RenderOptions options = small(set);
        options.reuse.automatic = shared;
        images.push_back(pixels(scene, options));
        options.lights = LightSampling::solid_angle;
        images_by_angle.push_back(pixels(scene, options));
      }
      CAPTURE(name, shared);
      for (const auto& image : images) CHECK(image == images[0]);
      for (const auto& image : images_by_angle) CHECK(image == images_by_angle[0]);
    }
}

TEST_CASE("the generic kernel gives the same bytes where the arithmetic is the same") {
  const Scene scene = standard_scene("cornell_box");
  RenderOptions options = small("auto"), generic = options;
  options.reuse = generic.reuse = {.automatic = false};
  generic.generic = true;
  const auto a = pixels(scene, options), b = pixels(scene, generic);
  double difference = 0, sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    difference += std::abs(luminance(a[i] - b[i]));
    sum += luminance(a[i]);
  }
  CHECK(difference < 1e-3 * sum);  // the same paths; a few part where a rounding differs
}

TEST_CASE("threads, crops and sample ranges do not show in sums of differences") {
  const Scene scene = standard_scene("kinds/cove");
  RenderOptions options = small("auto");
  options.reconstruct = Switch::on;
  const Film whole = render(scene, options).film;
  check_parts(scene, options, whole);
  options.crop = Window{0, 0, 11, 6, 30, 29};
  const DifferenceSums crop = render(scene, options).film.differences(),
                       part = whole.part({45, 37, 11, 6, 30, 29}).differences();
  CHECK(crop.all_counts() == part.all_counts());
  CHECK(crop.all_sums() == part.all_sums());
}

TEST_CASE("threads, crops and sample ranges do not show in a wavefront render") {
  const Scene scene = standard_scene("cornell_conductor");
  for (const auto& [shared, jitter] : {std::pair(true, true), {true, false}, {false, true}, {false, false}}) {
    RenderOptions options = small("auto");
    options.reuse.automatic = shared;
    options.jitter = jitter;
    options.threads = 1;
    const RenderResult whole = render(scene, options);
    check_parts(scene, options, whole.film);
  }
}

TEST_CASE("a pilot takes twice as many light paths for a lamp in a bulb, and the image is the same") {
  const Scene scene = standard_scene("kinds/lamp_in_bulb");
  RenderOptions options = small("auto");
  options.width = options.height = 64;
  const Film whole = render(scene, options).film;
  CHECK_THAT(whole.key, Catch::Contains("; light-path-number=twice"));
  check_parts(scene, options, whole);

  // Means over the image, whose light comes by light paths. |t| > 4.5 in 1 of 4000 tests (22 degrees)
  const auto means = [&](bool twice) {
    options.reuse.automatic = false;
    options.caustics = twice ? Switch::automatic : Switch::on;  // which asks no pilot
    options.spp = 1;
    double sum = 0, squares = 0;
    constexpr int seeds = 12;
    for (int seed = 1; seed <= seeds; ++seed) {
      options.seed = static_cast<std::uint32_t>(seed);
      const Film film = render(scene, options).film;
      REQUIRE(film.light_paths(0, 0) == (twice ? 2u : 1u) * 64 * 64);
      double mean = 0;
      for (const Vec3f& pixel : film.image().pixels) mean += luminance(pixel) / (64 * 64);
      sum += mean;
      squares += mean * mean;
    }
    const double mean = sum / seeds;
    return std::pair(mean, (squares / seeds - mean * mean) / (seeds - 1));
  };
  const auto [once, variance_once] = means(false);
  const auto [twice, variance_twice] = means(true);
  CAPTURE(once, twice, variance_once, variance_twice);
  CHECK(std::abs(once - twice) < 4.5 * std::sqrt(variance_once + variance_twice));
  CHECK(variance_once + variance_twice < 0.01 * once * once);
}

TEST_CASE("threads, crops, sample ranges and instruction sets do not show in caustics by light paths") {
  const Scene scene = standard_scene("kinds/lamp_in_bulb");
  RenderOptions options = small("auto");
  options.threads = 1;
  const RenderResult whole = render(scene, options);
  CHECK(whole.film.light_paths(0, 0) >= 4 * 45 * 37);
  CHECK_THAT(whole.film.key, Catch::Contains("; light-paths=on"));
  check_parts(scene, options, whole.film);

  for (const std::string& set : instruction_sets()) {
    options.isa = set;
    if (has_fma(set) && has_fma(whole.stats.isa))
      CHECK(bytes(render(scene, options).film) == bytes(whole.film));
  }
}

TEST_CASE(
    "scenes without smooth mirrors or glass, or with maps on smooth normals, have no paths from lights") {
  RenderOptions options = small("auto");
  CHECK(render(standard_scene("cornell_box"), options).film.light_paths(0, 0) == 0);
  Scene scene = standard_scene("kinds/lamp_in_bulb");
  options.caustics = Switch::off;
  CHECK(render(scene, options).film.light_paths(0, 0) == 0);
  options.caustics = Switch::on;
  CHECK(render(scene, options).film.light_paths(0, 0) > 0);
  CHECK_THROWS_WITH(render(standard_scene("cornell_box"), options), Catch::Contains("--caustics on"));
  Scene mapped = standard_scene("kinds/smooth_glass_ball");
  mapped.materials[0].map(SurfaceParameter::bump).texture = 0;
  CHECK_THROWS_WITH(render(mapped, options), Catch::Contains("both smooth normals and"));
  options.jitter = false;
  CHECK_THROWS_WITH(render(scene, options), Catch::Contains("--jitter off"));
}

TEST_CASE("tiles with ragged edges and moved grids give every pixel each sample once") {
  const Scene scene = standard_scene("furnace");
  RenderOptions options = small("auto");
  for (const Switch reconstruct : {Switch::off, Switch::on})
    for (std::uint64_t first = 0; first < 12; ++first) {
      options.reconstruct = reconstruct;
      options.samples = SampleRange{first, 1};
      const Film film = render(scene, options).film;
      for (int y = 0; y < options.height; ++y)
        for (int x = 0; x < options.width; ++x) REQUIRE(film.count(x, y) == 1);
    }
}

TEST_CASE("the kernels draw the numbers of sample_block") {
  for (const std::string& set : instruction_sets())
    for (const SamplerKind kind : {SamplerKind::sobol, SamplerKind::independent})
      for (std::uint32_t i = 0; i < 2000; ++i) {
        const std::uint32_t key = hash32(i), index = hash32(i + 7) >> 12, block = i % 23;
        float u[4];
        choose_kernel(set).sample_block(kind == SamplerKind::sobol, key, index, block, u);
        const std::array<float, 4> expected = sample_block(kind, key, index, block);
        REQUIRE(std::equal(u, u + 4, expected.begin()));
      }
}

TEST_CASE("an unknown instruction set is refused with the known ones") {
  CHECK_THROWS_WITH(choose_kernel("avx3"), Catch::Contains("use one of auto"));
}

TEST_CASE("a floor in the plane of an axis does not shadow itself") {
  // the middle of the scene is on the floor, so that its coordinates there are exactly zero
  SceneSketch sketch;
  Material floor, lamp;
  floor.kd = {0.5, 0.5, 0.5};
  lamp.ke = {1, 1, 1};
  lamp.two_sided_emission = true;
  const std::uint16_t grey = sketch.add_material(floor), light = sketch.add_material(lamp);
  sketch.add_quad({-1, 0, -1}, {-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, grey);
  sketch.add_quad({-1, 0.5f, -1}, {1, 0.5f, -1}, {1, 0.5f, 1}, {-1, 0.5f, 1}, light);
  sketch.scene.camera = make_camera({0, 0.3, -2}, {0, 0, 0}, {0, 1, 0}, 30);
  CHECK(list_from_tree(sketch.scene, 64) < 1e-3);
}

TEST_CASE("a list of more triangles than a shaft holds gathers what a tree does") {
  const Scene scene = box_with_mesh(8, 180, {278, 182, 280});
  CHECK(list_from_tree(scene, 8) < 0.01);
}

TEST_CASE("a list hides as much of the sky as a tree does") {
  CHECK(list_from_tree(standard_scene("kinds/sky_and_ground"), 16) < 1e-3);
}
