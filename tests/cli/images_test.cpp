#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/files.h"
#include "run_castray.h"
#include "test_image.h"

using namespace castray;
using Catch::Contains;

namespace {

/// a.pfm, b.pfm (a little brighter in one pixel), their pictures a.png and b.png, and more of other kinds.
struct Files {
  TemporaryFolder folder;

  Files() {
    Image image = test_image(12, 8);
    write_image(folder / "a.pfm", image);
    write_image(folder / "a.png", image);
    image.at(3, 5).y += 0.5f;
    write_image(folder / "b.pfm", image);
    write_image(folder / "b.png", image);
    write_image(folder / "small.pfm", test_image(8, 8));
    image.at(7, 2).x = std::numeric_limits<float>::quiet_NaN();
    write_image(folder / "nan.pfm", image);
    write_film(folder / "0.film", test_film(12, 8, 0, 4));
    write_film(folder / "4.film", test_film(12, 8, 4, 3));
    write_film(folder / "whole.film", test_film(12, 8, 0, 7));
  }

  RunResult run(const std::vector<std::string>& arguments) const {
    return run_castray(arguments, folder.path());
  }
};

}  // namespace

TEST_CASE("compare exits with 0 within the limits, 1 if not, and writes what it measured") {
  const Files files;
  const double mse = 0.25 / (3 * 12 * 8);
  const RunResult same = files.run({"compare", "a.pfm", "a.pfm", "--max", "mse=0", "--max", "max_error=0"});
  CHECK(same.exit_code == 0);
  CHECK(files.run({"compare", "b.pfm", "a.pfm"}).exit_code == 0);
  CHECK(files.run({"compare", "b.pfm", "a.pfm", "--max", "mse=1", "--max", "max_error=0.6"}).exit_code == 0);

  const RunResult different = files.run({"compare", "b.pfm", "a.pfm", "--max", "mse=1", "--max", "mae=0.001",
                                         "--json", "r.json", "--heatmap", "h.png"});
  CHECK(different.exit_code == 1);
  CHECK_THAT(different.out, Contains("EXCEEDS 0.001") && Contains("at pixel (3,5)"));
  CHECK(different.err.empty());
  const auto json = nlohmann::json::parse(read_file(files.folder / "r.json"));
  CHECK(json["pass"] == false);
  CHECK(json["metrics"]["mse"] == Approx(mse));
  CHECK(json["metrics"]["rmse"] == Approx(std::sqrt(mse)));
  CHECK(json["metrics"]["mae"] == Approx(0.5 / (3 * 12 * 8)));
  CHECK(json["bias_rgb"][1] == Approx(0.5 / (12 * 8)));
  CHECK(json["limits"]["mae"] == 0.001);
  CHECK(json["max_error_pixel"] == nlohmann::json{3, 5});
  CHECK(read_image(files.folder / "h.png").image.height > 8);
}

TEST_CASE("8 bits against float needs the tone curve, and then agrees to the rounding") {
  const Files files;
  const RunResult refused = files.run({"compare", "a.png", "a.pfm"});
  CHECK(refused.exit_code == 2);
  CHECK_THAT(refused.err, Contains("a.png: ") && Contains("--tone"));
  CHECK(files.run({"compare", "a.png", "a.pfm", "--tone", "srgb", "--max", "max_error=0.00197"}).exit_code ==
        0);
  CHECK(files.run({"compare", "a.pfm", "a.png", "--tone", "gamma:0.6", "--max", "max_error=0.00197"})
            .exit_code == 1);
  CHECK(files.run({"compare", "a.png", "a.png", "--max", "mse=0"}).exit_code == 0);
}

TEST_CASE("what cannot be compared, converted or merged is one line and exit code 2") {
  const Files files;
  struct Bad {
    std::vector<std::string> arguments;
    std::string says;
  };
  const std::vector<Bad> all = {
      {{"compare", "small.pfm", "a.pfm"}, "the image is 8x8, the reference 12x8"},
      {{"compare", "nan.pfm", "a.pfm"}, "pixel (7,2) of the image is not finite"},
      {{"compare", "a.png", "nan.pfm", "--tone", "srgb"}, "pixel (7,2) of the reference is not finite"},
      {{"compare", "absent.pfm", "a.pfm"}, "absent.pfm: cannot be read: No such file"},
      {{"compare", ".", "a.pfm"}, "known are"},
      {{"compare", "a.pfm"}, "REFERENCE"},
      {{"compare", "a.pfm", "b.pfm", "--max", "mze=1"}, "did you mean 'mse'"},
      {{"compare", "a.pfm", "b.pfm", "--max", "mse"}, "METRIC=VALUE"},
      {{"compare", "a.pfm", "b.pfm", "--max", "mse=nan"}, "METRIC=VALUE"},
      {{"compare", "a.pfm", "b.pfm", "--jsn", "r.json"}, "did you mean '--json'"},
      {{"compare", "a.pfm", "b.pfm", "--json", "no/r.json"}, "no/r.json: the folder no does not exist"},
      {{"compare", "a.png", "b.pfm", "--tone", "log"}, "unknown tone curve 'log'"},
      {{"compare", "a.pfm", "b.pfm", "--exposure", "nan"}, "--exposure"},
      {{"convert", "a.pfm"}, "--output"},
      {{"convert", "a.pfm", "-o", "a.jpg"}, "a.jpg: unknown image format '.jpg'; known are .ppm"},
      {{"convert", "a.pfm", "-o", "a.film"}, "another format"},
      {{"convert", "a.pfm", "-o", "c.exr", "--exposure", "1"}, "leave it out"},
      {{"merge", "0.film", "0.film", "-o", "m.film"}, "both films hold sample 0"},
      {{"merge", "0.film", "a.pfm", "-o", "m.film"}, "a.pfm: is not a film"},
      {{"comapre", "a.pfm"}, "did you mean 'compare'"},
      {{}, "say what to do: "},
  };
  for (const Bad& bad : all) {
    const RunResult result = files.run(bad.arguments);
    INFO(result.err);
    CHECK(result.exit_code == 2);
    CHECK(result.out.empty());
    CHECK_THAT(result.err, Catch::StartsWith("castray: error: ") && Contains(bad.says));
    CHECK(std::count(result.err.begin(), result.err.end(), '\n') == 1);
  }
  for (const char* name : {"a.jpg", "a.film", "c.exr", "m.film"})
    CHECK_FALSE(std::filesystem::exists(files.folder / name));
}

TEST_CASE("merge gives the bytes of the whole film in any order, and pictures too") {
  const Files files;
  CHECK(files.run({"merge", "0.film", "4.film", "-o", "m.film", "-o", "m.exr"}).exit_code == 0);
  CHECK(read_file(files.folder / "m.film") == read_file(files.folder / "whole.film"));
  CHECK(files.run({"merge", "4.film", "0.film", "-o", "m.film"}).exit_code == 0);
  CHECK(read_file(files.folder / "m.film") == read_file(files.folder / "whole.film"));
  CHECK(read_image(files.folder / "m.exr").metadata.at("castray:spp") == "7");
  CHECK(files.run({"compare", "m.exr", "whole.film", "--max", "max_error=0"}).exit_code == 0);
}

TEST_CASE("convert keeps what the target can hold") {
  const Files files;
  CHECK(files.run({"convert", "a.pfm", "-o", "c.exr", "-o", "c.png", "-o", "d.ppm", "--tone", "gamma:0.6"})
            .exit_code == 0);
  CHECK(files.run({"compare", "c.exr", "a.pfm", "--max", "max_error=0"}).exit_code == 0);
  CHECK(files.run({"compare", "c.png", "d.ppm", "--max", "max_error=0"}).exit_code == 0);
  CHECK(files.run({"convert", "c.png", "-o", "e.png", "--tone", "gamma:0.6"}).exit_code == 0);
  CHECK(files.run({"compare", "c.png", "e.png", "--max", "max_error=0"}).exit_code == 0);
  const RunResult with_nan = files.run({"convert", "nan.pfm", "-o", "n.png"});
  CHECK(with_nan.exit_code == 0);
  CHECK_THAT(with_nan.err, Contains("n.png: 1 pixels are not finite; NaN is shown black"));
  CHECK(read_image(files.folder / "n.png").image.at(7, 2).x == 0);
}
