#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "core/files.h"
#include "run_castray.h"
#include "test_image.h"

using namespace castray;
using Catch::Contains;

namespace {

/// cornell_box at 64x64 and another seed each: as a film and as EXR of the same render; brighter ones too.
struct Renders {
  TemporaryFolder folder;

  Renders() {
    for (const char* seed : {"1", "2"}) render(CASTRAY_ROOT "/scenes/cornell_box.json", seed, "");
    render(CASTRAY_ROOT "/scenes/cornell_lights.json", "3", "other");
  }
  void render(const std::string& scene, const std::string& seed, const std::string& name) const {
    const RunResult result =
        run({"render", scene, "-q", "--size", "64x64", "--spp", "32", "--replicates", "8", "--seed", seed,
             "-o", name + seed + ".film", "-o", name + seed + ".exr", "-o", name + seed + ".pfm"});
    REQUIRE(result.exit_code == 0);
  }
  RunResult run(const std::vector<std::string>& arguments) const {
    return run_castray(arguments, folder.path());
  }
  int compare(const std::string& image, const std::string& reference) const {
    return run({"compare", image, reference, "--ztest", "0.001", "--json", "r.json"}).exit_code;
  }
};

}  // namespace

TEST_CASE("the z-test holds films and EXR files of replicates against each other in any pair") {
  const Renders renders;
  for (const char* image : {"2.film", "2.exr"})
    for (const char* reference : {"1.film", "1.exr"}) {
      INFO(image << " " << reference);
      CHECK(renders.compare(image, reference) == 0);
    }
  for (const char* image : {"other3.film", "other3.exr"})
    for (const char* reference : {"1.film", "1.exr"}) {
      INFO(image << " " << reference);
      CHECK(renders.compare(image, reference) == 1);
    }
  const auto json = nlohmann::json::parse(read_file(renders.folder / "r.json"));
  CHECK(json["ztest"]["pass"] == false);
  CHECK(json["ztest"]["p"] < 0.001);
  CHECK(json["ztest"]["p"] > 0);
  CHECK_THAT(renders.run({"info", "1.exr"}).out,
             Contains("told by a variance of each value, of 7 degrees of freedom"));
  CHECK(renders.run({"convert", "1.film", "-o", "c.exr"}).exit_code == 0);
  CHECK(renders.compare("2.exr", "c.exr") == 0);
  const RunResult plain = renders.run({"compare", "1.pfm", "1.exr", "--ztest", "0.01"});
  CHECK(plain.exit_code == 2);
  CHECK_THAT(plain.err, Contains("1.pfm against 1.exr: the image does not tell its noise"));
}

TEST_CASE("references of half precision take a tenth of a film's room, and judge as well") {
  const Renders renders;
  for (const std::string name : {"1", "2", "other3"})
    REQUIRE(renders.run({"convert", name + ".film", "--bits", "16", "-o", name + "half.exr"}).exit_code == 0);
  const auto size = [&](const char* name) { return std::filesystem::file_size(renders.folder / name); };
  CHECK(size("1half.exr") * 10 < size("1.film"));
  CHECK_THAT(renders.run({"info", "1half.exr"}).out, Contains("of 7 degrees of freedom"));
  for (const char* image : {"2.film", "2.exr", "2half.exr", "1.exr"}) {
    INFO(image);
    CHECK(renders.compare(image, "1half.exr") == 0);
  }
  for (const char* image : {"other3.film", "other3.exr", "other3half.exr"}) {
    INFO(image);
    CHECK(renders.compare(image, "1half.exr") == 1);
  }
}

TEST_CASE("a background without noise may be rounded to half floats, and no further") {
  const TemporaryFolder folder;
  const auto run = [&](const std::vector<std::string>& arguments) {
    return run_castray(arguments, folder.path()).exit_code;
  };
  write_file(folder / "t.obj", "v -1 -1 0\nv 0 1 0\nv 1 -1 0\nf 1 2 3\n");
  const auto render = [&](const std::string& sky, const std::string& name, const std::string& bits) {
    write_file(
        folder / "s.json",
        R"({ "camera": { "position": [0, 0, 9], "look_at": [0, 0, 20] }, "environment": { "radiance": [)" +
            sky + "] }, \"meshes\": [ { \"obj\": \"t.obj\" } ] }");
    REQUIRE(run({"render", "s.json", "-q", "--size", "16x16", "--replicates", "4", "--bits", bits, "-o",
                 name}) == 0);
  };
  render("0.3, 0.5003, 0.7", "half.exr", "16");
  render("0.3, 0.5003, 0.7", "whole.exr", "auto");
  render("0.3, 0.5023, 0.7", "brighter.exr", "16");
  CHECK(run({"compare", "whole.exr", "half.exr", "--max", "max_error=0"}) == 1);
  CHECK(run({"compare", "whole.exr", "half.exr", "--ztest", "0.01"}) == 0);
  CHECK(run({"compare", "brighter.exr", "half.exr", "--ztest", "0.01"}) == 1);
}

TEST_CASE("the z-test takes PFM files with their variances beside them") {
  const TemporaryFolder folder;
  Image image = test_image(16, 16), variance(16, 16);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) variance.pixels[i] = image.pixels[i] * 1e-4f;
  for (const char* name : {"a", "b"}) write_image(folder / (std::string(name) + ".variance.pfm"), variance);
  write_image(folder / "a.pfm", image);
  const auto compare = [&](float factor) {
    Image changed = image;
    for (Vec3f& v : changed.pixels) v *= factor;
    write_image(folder / "b.pfm", changed);
    return run_castray({"compare", "b.pfm", "a.pfm", "--ztest", "0.01"}, folder.path()).exit_code;
  };
  CHECK(compare(1) == 0);
  CHECK(compare(1.0001f) == 0);
  CHECK(compare(1.01f) == 1);
}
