#include <catch2/catch.hpp>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "castray/render.h"
#include "castray/scene.h"
#include "reference_images.h"
#include "temporary_folder.h"
#include "test_scenes.h"

using namespace castray;
using namespace castray::test;

namespace {

constexpr double cornell_size = 560;

/// How the world of a scene is scaled, then moved, along each axis.
struct Placement {
  double scale = 1, offset = 0;
  double map(double x) const { return x * scale + offset; }
};

/// The Cornell box from files in which everything, the camera too, is scaled and moved.
Scene cornell_at(const Placement& place) {
  const std::filesystem::path scenes = std::filesystem::path(CASTRAY_ROOT) / "scenes";
  std::ifstream in(scenes / "cornell_box.json");
  nlohmann::json scene = nlohmann::json::parse(in, nullptr, true, true);
  for (const char* key : {"position", "look_at"})
    for (auto& x : scene["camera"][key]) x = place.map(x.get<double>());
  for (auto& mesh : scene["meshes"]) {
    mesh["obj"] = (scenes / mesh["obj"].get<std::string>()).string();
    mesh["transform"] = {{{"scale", place.scale}},
                         {{"translate", {place.offset, place.offset, place.offset}}}};
  }
  const TemporaryFolder folder;
  std::ofstream(folder / "moved.json") << scene;
  return load_scene(folder / "moved.json");
}

std::vector<std::vector<double>> renders(const Scene& scene, Integrator integrator,
                                         std::uint64_t first_seed) {
  RenderOptions options;
  options.integrator = integrator;
  options.width = options.height = 64;
  options.spp = 16;
  std::vector<std::vector<double>> means;
  for (options.seed = first_seed; options.seed < first_seed + 12; ++options.seed)
    means.push_back(block_means(render(scene, options).film.image(), 8));
  return means;
}

std::vector<Placement> placements() {
  std::vector<Placement> all;
  for (const double scale : {1e-6, 1e-3, 1.0, 1e3, 1e6})
    for (const double offset : {0.0, 1e3, 1e5, 1e7}) all.push_back({scale, offset * scale * cornell_size});
  return all;
}

}  // namespace

TEST_CASE("a scene is the same shape at every scale and place, up to the rounding of its coordinates") {
  const Scene original = cornell_at({});
  for (const Placement& place : placements()) {
    INFO("scale " << place.scale << ", offset " << place.offset);
    const Scene scene = cornell_at(place);
    REQUIRE(scene.triangles == original.triangles);
    CHECK(scene.dropped_triangles == 0);
    CHECK(scene.warnings.empty());
    const double float_rounding = 0x1p-23 * scene.unit, double_rounding = 0x1p-50 * std::abs(place.offset);
    for (std::size_t i = 0; i < scene.positions.size(); ++i) {
      const Vec3d here = scene.to_world(Vec3d(scene.positions[i]));
      const Vec3d there = original.to_world(Vec3d(original.positions[i]));
      for (int k = 0; k < 3; ++k)
        CHECK(std::abs(here[k] - place.map(there[k])) <=
              float_rounding + double_rounding + 0x1p-23 * original.unit * place.scale);
    }
  }
}

namespace {

/// One false alarm in 1000 runs of all placements.
void check_brightness(const std::vector<Placement>& places, Integrator integrator) {
  const ExpectedBlocks expected(renders(cornell_at({}), integrator, 1));
  for (const Placement& place : places) {
    INFO("scale " << place.scale << ", offset " << place.offset);
    const BlockScores scores =
        block_scores(renders(cornell_at(place), integrator, 100), expected.mean, expected.variance);
    CHECK(scores.count > 150);
    CHECK(scores.largest < score_limit(scores.count, 1e-3 / static_cast<double>(places.size())));
  }
}

}  // namespace

TEST_CASE("the Cornell box is as bright when tiny or huge and far away") {
  for (const Integrator integrator : {Integrator::wavefront, Integrator::reference})
    check_brightness({{1e-6, 1e7 * 1e-6 * cornell_size}, {1e6, 1e7 * 1e6 * cornell_size}}, integrator);
}

TEST_CASE("the Cornell box is as bright at every scale and place", "[long]") {
  for (const Integrator integrator : {Integrator::wavefront, Integrator::reference})
    check_brightness(placements(), integrator);
}

TEST_CASE("far parts that spoil the precision of near ones are told, with the loss that is measured") {
  const TemporaryFolder folder;
  const auto warnings = [&](const std::string& far) {
    std::ofstream(folder / "o.obj") << "mtllib o.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nv " << far
                                    << " 0 0\nv " << far << " 1e3 0\nv " << far << " 0 1e3\nf 4 5 6\n";
    std::ofstream(folder / "o.mtl") << "newmtl a\nKe 1 1 1\n";
    return load_scene(folder / "o.obj").warnings;
  };
  CHECK(warnings("1e3").empty());
  // A unit triangle 1.5e6 from its scene's middle has coordinates in steps of 2^-3 at 2^20 .. 2^21.
  const std::vector<SceneWarning> told = warnings("3000000.3");
  REQUIRE(told.size() == 1);
  CHECK(told[0].message.starts_with(
      "1 of 2 triangles are so small beside the whole scene that rounding moves their corners"));
}
