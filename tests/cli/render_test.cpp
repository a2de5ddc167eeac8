#include <catch2/catch.hpp>

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>
#include <sstream>

#include "castray/film.h"
#include "core/files.h"
#include "run_castray.h"

using namespace castray;
using Catch::Contains;

namespace {

const std::string cornell = CASTRAY_ROOT "/scenes/cornell_box.json";

/// A render of the Cornell box in 16x16 pixels by the reference, in the folder.
RunResult render_small(const TemporaryFolder& folder, std::vector<std::string> more) {
  std::vector<std::string> arguments{"render", cornell, "--size", "16x16", "--integrator", "reference"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return run_castray(arguments, folder.path());
}

nlohmann::json stats_in(const TemporaryFolder& folder) {
  return nlohmann::json::parse(read_file(folder / "s.json"));
}

}  // namespace

TEST_CASE("render writes every output, tells the summary on stderr and its times in --stats") {
  const TemporaryFolder folder;
  const RunResult result = render_small(folder, {"--spp", "2", "--accel", "bvh", "-o", "x.png", "-o", "x.pfm",
                                                 "-o", "x.film", "--stats", "s.json"});
  CHECK(result.exit_code == 0);
  CHECK(result.out.empty());
  CHECK_THAT(result.err,
             Contains("BVH generation complete") && Contains("Render complete") && Contains("spp"));
  CHECK(folder.names() == std::vector<std::string>{"s.json", "x.film", "x.pfm", "x.png"});
  CHECK(read_image(folder / "x.pfm").image.pixels == read_film(folder / "x.film").image().pixels);

  const auto stats = stats_in(folder);
  for (const char* key : {"version",
                          "scene",
                          "width",
                          "height",
                          "spp",
                          "seed",
                          "threads",
                          "isa",
                          "kernel",
                          "skipped",
                          "triangles",
                          "lights",
                          "load_seconds",
                          "bvh_seconds",
                          "render_seconds",
                          "total_seconds",
                          "paths",
                          "rays",
                          "mpaths_per_second",
                          "mrays_per_second",
                          "peak_memory_bytes",
                          "nonfinite_samples",
                          "stopped"})
    CHECK(stats.contains(key));
  CHECK(stats["stopped"] == "done");
  CHECK(stats["paths"] == 2 * 16 * 16);
  CHECK(stats["triangles"] == 32);
  CHECK(stats["nonfinite_samples"] == 0);
}

TEST_CASE("without -o the image is named after the scene") {
  const TemporaryFolder folder;
  CHECK(render_small(folder, {"--spp", "1", "-q"}).exit_code == 0);
  CHECK(folder.names() == std::vector<std::string>{"cornell_box.png"});
}

TEST_CASE("the scene's own defaults apply, the command line wins") {
  const TemporaryFolder folder;
  std::string scene = read_file(cornell);
  const std::string given = "\"render\": { \"spp\": 64 }";
  scene.replace(scene.find(given), given.size(), "\"render\": { \"spp\": 3, \"seed\": 5 }");
  for (std::size_t at; (at = scene.find("../models")) != std::string::npos;)
    scene.replace(at, 9, CASTRAY_ROOT "/models");
  write_file(folder / "own.json", scene);
  const std::vector<std::string> arguments{"render", "own.json", "--size", "8x8", "-q", "--stats", "s.json"};
  REQUIRE(run_castray(arguments, folder.path()).exit_code == 0);
  CHECK(stats_in(folder)["spp"] == 3);
  CHECK(stats_in(folder)["seed"] == 5);
  std::vector<std::string> more = arguments;
  more.insert(more.end(), {"--spp", "2"});
  REQUIRE(run_castray(more, folder.path()).exit_code == 0);
  CHECK(stats_in(folder)["spp"] == 2);

  scene.replace(scene.find("\"seed\""), 6, "\"sead\"");
  write_file(folder / "own.json", scene);
  const RunResult wrong = run_castray(arguments, folder.path());
  CHECK(wrong.exit_code == 2);
  CHECK_THAT(wrong.err, Contains("own.json:6:") && Contains("did you mean 'seed'"));
}

TEST_CASE("render refuses what it does not understand, in one line, before it starts") {
  const TemporaryFolder folder;
  struct Case {
    std::vector<std::string> arguments;
    const char* message;
  };
  const Case cases[] = {
      {{"render"}, "SCENE is missing; see castray render --help"},
      {{"render", cornell, "--sppp", "4"}, "did you mean '--spp'"},
      {{"render", cornell, "extra"}, "extra"},
      {{"render", cornell, "--spp", "0"}, "--spp '0'"},
      {{"render", cornell, "--spp", "-3"}, "--spp '-3'"},
      {{"render", cornell, "--spp", "1e18"}, "--spp '1e18'"},
      {{"render", cornell, "--size", "640"}, "--size '640'"},
      {{"render", cornell, "--size", "99999999x99999999"}, "--size"},
      {{"render", cornell, "--size", "65536x65536"}, "--size"},
      {{"render", cornell, "--crop", "0,0,0,0"}, "--crop"},
      {{"render", cornell, "--rr", "2"}, "--rr"},
      {{"render", cornell, "--rr", "nan"}, "--rr"},
      {{"render", cornell, "--max-depth", "0"}, "--max-depth '0'"},
      {{"render", cornell, "--epsilon", "x"}, "--epsilon 'x'"},
      {{"render", cornell, "--integrator", "refrence"}, "did you mean 'reference'"},
      {{"render", cornell, "--sampler", "halton"}, "known: sobol, independent"},
      {{"render", cornell, "--tone", "gama:2"}, "gama:2"},
      {{"render", cornell, "--fault", "blacklight", "--integrator", "reference"},
       "did you mean 'black-light'"},
      {{"render", cornell, "--threads", "0"}, "--threads '0'"},
      {{"render", cornell, "--samples", "4"}, "--samples '4'"},
      {{"render", cornell, "--resume"}, "--checkpoint"},
      {{"render", cornell, "--checkpoint", "c.png"}, ".film"},
      {{"render", cornell, "-o", "x.gif"}, ".gif"},
      {{"render", cornell, "-o", "no/x.png"}, "does not exist"},
      {{"render", cornell, "--stats", "no/s.json"}, "does not exist"},
      {{"render", cornell, "--fov", "180"}, "fov"},
      {{"render", cornell, "--look-at", "1,2"}, "X,Y,Z"},
      {{"render", "none.json"}, "none.json"},
  };
  for (const Case& c : cases) {
    const RunResult result = run_castray(c.arguments, folder.path());
    CAPTURE(c.message, result.err);
    CHECK(result.exit_code == 2);
    CHECK(result.error_lines() == 1);
    CHECK_THAT(result.err, Contains("castray: error: ") && Contains(c.message));
    CHECK(folder.names().empty());
  }
}

TEST_CASE("a sample that is not finite is told with the command that renders it again") {
  const TemporaryFolder folder;
  write_file(folder / "floor.obj", "v -1 0 1\nv 1 0 1\nv 1 0 -1\nv -1 0 -1\nf 1 2 3 4\n");
  // so near to a light without size that float overflows
  write_file(folder / "hot.json",
             R"({ "camera": { "position": [0, 0.2, 0.9], "look_at": [0, 0, 0], "fov": 0.05 },
    "materials": { "floor": { "type": "diffuse" } }, "meshes": [ { "obj": "floor.obj", "material": "floor" } ],
    "lights": [ { "type": "point", "position": [0, 1e-5, 0], "intensity": [1e30, 1e30, 1e30] } ] })");
  const RunResult first = run_castray({"render", "hot.json", "--size", "8x8", "--spp", "64", "--seed", "3",
                                       "--integrator", "reference", "--mis", "off", "--stats", "s.json"},
                                      folder.path());
  CAPTURE(first.err);
  REQUIRE(first.exit_code == 0);
  REQUIRE(stats_in(folder)["nonfinite_samples"] > 0);
  const std::string begin = ": castray render ";
  const std::size_t at = first.err.find(begin) + 2;
  REQUIRE(at < first.err.size());
  std::istringstream command(first.err.substr(at, first.err.find('\n', at) - at));
  std::vector<std::string> words{std::istream_iterator<std::string>(command), {}};
  words.erase(words.begin());
  words.insert(words.end(), {"--stats", "s.json"});
  REQUIRE(run_castray(words, folder.path()).exit_code == 0);
  CHECK(stats_in(folder)["nonfinite_samples"] == 1);
  CHECK(stats_in(folder)["paths"] == 1);
}

TEST_CASE("clamp-indirect is told to be biased in the log, the statistics and every output") {
  const TemporaryFolder folder;
  for (const bool clamps : {true, false}) {
    std::vector<std::string> arguments{"--spp", "1", "--stats", "s.json"};
    for (const char* name : {"x.png", "x.exr", "x.film"}) arguments.insert(arguments.end(), {"-o", name});
    if (clamps) arguments.insert(arguments.end(), {"--clamp-indirect", "2"});
    const RunResult result = render_small(folder, arguments);
    REQUIRE(result.exit_code == 0);
    CHECK((result.err.find("biased: --clamp-indirect 2") != std::string::npos) == clamps);
    CHECK(stats_in(folder)["biased"] == clamps);
    for (const char* name : {"x.png", "x.exr", "x.film"}) {
      const auto metadata = read_image(folder / name).metadata;
      CHECK(metadata.contains("castray:biased") == clamps);
      if (clamps) CHECK(metadata.at("castray:biased") == "clamp-indirect=2");
    }
  }
}

TEST_CASE("an .obj is seen by an automatic view or by camera flags") {
  const TemporaryFolder folder;
  const std::string obj = CASTRAY_ROOT "/models/cornell_box/cornell_box.obj";
  REQUIRE(run_castray({"render", obj, "--size", "16x16", "--spp", "4", "--integrator", "reference", "-q",
                       "-o", "a.pfm"},
                      folder.path())
              .exit_code == 0);
  REQUIRE(run_castray({"render", obj, "--size", "16x16", "--spp", "4", "--integrator", "reference", "-q",
                       "--look-from", "278,273,-800", "--look-at", "278,273,0", "--fov", "40", "-o", "b.pfm"},
                      folder.path())
              .exit_code == 0);
  REQUIRE(run_castray({"render", cornell, "--size", "16x16", "--spp", "4", "--integrator", "reference", "-q",
                       "-o", "c.pfm"},
                      folder.path())
              .exit_code == 0);
  const Image flags = read_image(folder / "b.pfm").image, scene = read_image(folder / "c.pfm").image;
  double difference = 0, sum = 0;
  for (std::size_t i = 0; i < flags.pixels.size(); ++i) {
    difference += std::abs(double(flags.pixels[i].y - scene.pixels[i].y));
    sum += double(scene.pixels[i].y);
  }
  CHECK(difference < 0.01 * sum);  // the same view of the same box, but for roundings
  CHECK(read_image(folder / "a.pfm").image.pixels != flags.pixels);
}

TEST_CASE("a suffix in capitals is the same format: an .OBJ gets the automatic view of an .obj") {
  const TemporaryFolder folder;
  write_file(folder / "lamp.mtl", "newmtl lamp\nKd 0 0 0\nKe 1 1 1\n");
  for (const char* name : {"lamp.obj", "LAMP2.OBJ"}) {
    write_file(folder / name,
               "mtllib lamp.mtl\nusemtl lamp\nv -1 -3 0\nv 1 -3 0\nv 1 3 0\nv -1 3 0\nf 1 2 3 4\n");
    const RunResult result = run_castray(
        {"render", name, "--size", "48x24", "--spp", "1", "-q", "-o", std::string(name) + ".film"},
        folder.path());
    CHECK(result.exit_code == 0);
  }
  const Image lower = read_film(folder / "lamp.obj.film").image();
  CHECK(std::any_of(lower.pixels.begin(), lower.pixels.end(), [](const Vec3f& p) { return p.x == 1; }));
  CHECK(read_film(folder / "LAMP2.OBJ.film").image().pixels == lower.pixels);
}

TEST_CASE("an absolute epsilon says that it is the reference which renders") {
  const TemporaryFolder folder;
  const auto err = [&](std::vector<std::string> flags) {
    flags.insert(flags.begin(), {"render", cornell, "--size", "8x8", "--spp", "1", "-o", "x.film"});
    const RunResult result = run_castray(flags, folder.path());
    CHECK(result.exit_code == 0);
    return result.err;
  };
  CHECK_THAT(err({"--epsilon", "0.01"}), Contains("castRay, float") && Contains("only it has an absolute"));
  CHECK_THAT(err({"--epsilon", "0.01", "--integrator", "reference"}), !Contains("only it has"));
  CHECK_THAT(err({}), !Contains("only it has") && !Contains("castRay"));
}

TEST_CASE("info tells what a render would choose") {
  const TemporaryFolder folder;
  CHECK_THAT(run_castray({"info", cornell}, folder.path()).out,
             Contains("kernel     list, diffuse") && Contains("not needed tree"));
}

TEST_CASE("a flag of a scene's own that is refused late is told with its place") {
  const TemporaryFolder folder;
  write_file(folder / "t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  write_file(folder / "s.json",
             "{ \"meshes\": [ { \"obj\": \"t.obj\" } ],\n  \"render\": { \"spp\": 1, \"isa\": \"mmx\" } }\n");
  const auto err = [&](std::vector<std::string> flags) {
    flags.insert(flags.begin(), {"render", "s.json", "--size", "8x8", "-q", "-o", "x.pfm"});
    return run_castray(flags, folder.path()).err;
  };
  CHECK_THAT(err({}), Catch::StartsWith("castray: error: s.json:2:25: --isa mmx: unknown"));
  CHECK_THAT(err({"--isa", "sse9"}), Catch::StartsWith("castray: error: --isa sse9: unknown"));
  CHECK(err({"--isa", "auto"}).empty());
}
