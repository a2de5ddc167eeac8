#include "image/reconstruction.h"

#include <catch2/catch.hpp>

#include <filesystem>
#include <functional>

#include "box_scenes.h"
#include "castray/render.h"
#include "reference_images.h"

using namespace castray;
using namespace castray::test;

// An image and the mean of its samples, which has no bias (wavefront_test.cpp), must agree on average. The
// samples are the same, so that small differences show.

namespace {

constexpr int side = 64, block = 8;

RenderOptions options_of(std::uint64_t spp, std::uint64_t seed) {
  RenderOptions options;
  options.width = options.height = side;
  options.spp = spp;
  options.seed = seed;
  options.reconstruct = Switch::on;
  return options;
}

struct Corrections {
  std::vector<std::vector<double>> blocks;  ///< by render
  Mean relative;                            ///< of all pixels, over that of the image
};

double mean_of(const Image& image) {
  double sum = 0;
  for (const Vec3f& p : image.pixels) sum += luminance(Vec3d(p));
  return sum / static_cast<double>(image.pixels.size());
}

Corrections corrections_of(const Scene& scene, std::uint64_t spp, std::uint64_t seeds, int edge_samples = 1) {
  Corrections result;
  RenderOptions options = options_of(spp, 500);
  options.edge_samples = edge_samples;
  const PreparedScene prepared(scene, options);
  for (std::uint64_t seed = 0; seed < seeds; ++seed, ++options.seed) {
    const Film film = render(prepared, options).film;
    Image difference = image_of(film);
    const Image mean = film.image();
    for (std::size_t i = 0; i < mean.pixels.size(); ++i)
      difference.pixels[i] = difference.pixels[i] - mean.pixels[i];
    result.relative.add(mean_of(difference) / mean_of(mean));
    result.blocks.push_back(block_means(difference, block));
  }
  return result;
}

/// No block is off, at a false-alarm rate of 1e-5 a scene, nor are all of them a little.
void check_unbiased(const std::string& name, const Corrections& corrections) {
  const std::vector<double> nothing(corrections.blocks[0].size());
  const BlockScores scores = block_scores(corrections.blocks, nothing, nothing);
  CAPTURE(name, scores.rms, scores.largest, corrections.relative.mean(), corrections.relative.error());
  CHECK(scores.largest < score_limit(scores.count, 1e-5));
  CHECK(scores.rms < rms_limit(scores));
  CHECK(std::abs(corrections.relative.mean()) <= 4.5 * corrections.relative.error());
}

/// Blocks of films that keep differences, as `options` says, and of others with other seeds.
void check_same_mean(const char* name, const Scene& scene, std::uint64_t seeds, RenderOptions options) {
  options.width = options.height = 32;
  RenderOptions plain_options = options;
  plain_options.seed += 1000;
  plain_options.reconstruct = Switch::off;
  plain_options.edge_samples.reset();
  std::vector<std::vector<double>> plain, more;
  for (std::uint64_t seed = 0; seed < seeds; ++seed, ++options.seed, ++plain_options.seed) {
    more.push_back(block_means(render(scene, options).film.image(), 4));
    plain.push_back(block_means(render(scene, plain_options).film.image(), 4));
  }
  const ExpectedBlocks expected(plain);
  const BlockScores scores = block_scores(more, expected.mean, expected.variance);
  CAPTURE(name, scores.rms, scores.largest, scores.independent);
  CHECK(scores.largest < score_limit(scores.count, 1e-5));
  CHECK(scores.rms < rms_limit(scores));
}

}  // namespace

/// Of what scenes/ holds little of.
const std::vector<std::pair<const char*, std::function<Scene()>>> made_scenes = {
    {"mesh", [] { return box_with_mesh(); }},
    {"coverage", [] { return box_with([](Material& m) { m.coverage = 0.6; }); }},
    {"textures", [] { return with_detail(standard_scene("cornell_box")); }},
};

TEST_CASE("reconstructed images have the mean of their samples in every block", "[statistical]") {
  for (const char* name : {"cornell_box", "cornell_conductor", "cornell_lights", "kinds/sun_and_sky",
                           "kinds/glass_ball", "kinds/facing_mirrors", "kinds/tiny_lamp"})
    check_unbiased(name, corrections_of(standard_scene(name), 6, 40));
  for (const std::uint64_t few : {1u, 2u, 5u})
    for (const char* name : {"cornell_box", "kinds/cove"})
      check_unbiased(name, corrections_of(standard_scene(name), few, 40));
  check_unbiased("more samples at edges", corrections_of(standard_scene("cornell_box"), 6, 40, 3));
  for (const auto& [name, make] : made_scenes) check_unbiased(name, corrections_of(make(), 6, 40));
}

TEST_CASE("outlines of lamps, seen by more rays, have the mean of all samples", "[statistical]") {
  for (const char* name : {"cornell_box", "cornell_lights", "kinds/glowing_meshes", "kinds/sky_and_ground"})
    check_same_mean(name, standard_scene(name), 64, options_of(2, 3000));
}

TEST_CASE("places at edges, sampled more often, have the mean of all samples", "[statistical]") {
  RenderOptions options = options_of(3, 5000);
  options.edge_samples = 4;
  check_same_mean("mirrors", standard_scene("kinds/facing_mirrors"), 40, options);
  check_same_mean("coverage", box_with([](Material& m) { m.coverage = 0.6; }), 40, options);
}

TEST_CASE("many seeds show no bias of reconstructed images, in any scene", "[statistical][long]") {
  const auto check = [](const Scene& scene) {
    for (const std::uint64_t spp : {1u, 4u, 16u}) {
      const Corrections corrections = corrections_of(scene, spp, 512, 3);
      check_unbiased(std::to_string(spp) + " samples", corrections);
      CHECK(std::abs(corrections.relative.mean()) < 1e-4 + 3 * corrections.relative.error());
    }
  };
  for (const auto& [name, make] : made_scenes) DYNAMIC_SECTION(name) {
      check(make());
    }
  for (const std::string folder : {"", "kinds/"})
    for (const auto& entry :
         std::filesystem::directory_iterator(std::string(CASTRAY_ROOT) + "/scenes/" + folder)) {
      const std::string name = folder + entry.path().stem().string();
      if (entry.path().extension() == ".json" && name != "castray.schema") DYNAMIC_SECTION(name) {
          check(standard_scene(name));
        }
    }
}

TEST_CASE("weights of the same samples would make a render darker", "[statistical]") {
  const Scene scene = standard_scene("cornell_box");
  Mean bias;
  for (std::uint64_t seed = 0; seed < 80; ++seed) {
    RenderOptions options = options_of(16, 900 + seed);
    options.edge_samples = 1;  // else there is less noise to be mistaken for light
    const Film film = render(scene, options).film;
    const PixelPlanes correction = corrections(film.differences(), 1, WeightsOf::same_half)[0];
    double sum = 0, brightness = 0;
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        sum += static_cast<double>(correction[1].row(y)[x]);
        brightness += film.mean(x, y).y;
      }
    bias.add(sum / brightness);
  }
  CAPTURE(bias.mean(), bias.error());
  CHECK(bias.mean() < -5 * bias.error());
}
