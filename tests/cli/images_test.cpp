#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/files.h"
#include "run_castray.h"
#include "small_files.h"
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
  CHECK_THAT(different.out, Contains("EXCEEDS <= 0.001") && Contains("at pixel (3,5)"));
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
      {{"compare", "absent.pfm", "a.pfm"}, "absent.pfm: does not exist"},
      {{"compare", ".", "a.pfm"}, "is a folder"},
      {{"compare", "a.pfm"}, "REFERENCE"},
      {{"compare", "a.pfm", "b.pfm", "--max", "mze=1"}, "did you mean 'mse'"},
      {{"compare", "a.pfm", "b.pfm", "--max", "mse"}, "METRIC=VALUE"},
      {{"compare", "a.pfm", "b.pfm", "--max", "mse=nan"}, "METRIC=VALUE"},
      {{"compare", "a.pfm", "b.pfm", "--jsn", "r.json"}, "did you mean '--json'"},
      {{"compare", "a.pfm", "b.pfm", "--json", "no/r.json"}, "no/r.json: the folder no does not exist"},
      {{"compare", "a.png", "b.pfm", "--tone", "log"}, "unknown tone curve 'log'"},
      {{"compare", "a.pfm", "b.pfm", "--exposure", "nan"}, "--exposure"},
      {{"convert", "a.pfm"}, "--output"},
      {{"convert", "a.pfm", "-o", "a.jpg"}, "a.jpg: images of '.jpg' are read only; written are .ppm"},
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

TEST_CASE("folders are compared image by image, under the limits of a file, with reports") {
  const Files files;
  const auto& folder = files.folder;
  for (const char* side : {"image/sub", "reference/sub"}) std::filesystem::create_directories(folder / side);
  write_file(folder / "image/a.pfm", read_file(folder / "b.pfm"));
  write_file(folder / "reference/a.pfm", read_file(folder / "a.pfm"));
  for (const char* side : {"image/sub/p.png", "reference/sub/p.png"})
    write_file(folder / side, read_file(folder / "a.png"));
  write_file(folder / "limits.json",
             R"({"max": {"mse": 0}, // strict
                 "images": {"a.pfm": {"max": {"mse": 1}, "allow-pixels": "1.1:0.4"}}})");
  const std::vector<std::string> compare = {"compare", "image", "reference", "--limits", "limits.json"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), compare.begin(), compare.end());
    return files.run(more);
  };
  CHECK(with({}).exit_code == 0);
  CHECK(with({"--allow-pixels", "1:0.4"}).exit_code == 1);  // one pixel of 96 is 1.04 %
  const RunResult strict =
      with({"--max", "max_error=0.1", "--json", "r.json", "--junit", "r.xml", "--html", "r.html"});
  CHECK(strict.exit_code == 1);
  CHECK_THAT(strict.out,
             Contains("FAIL  a.pfm") && Contains("pass  sub/p.png") && Contains("1 of 2 images pass"));
  const auto json = nlohmann::json::parse(read_file(folder / "r.json"));
  CHECK(json["pass"] == false);
  CHECK(json["comparisons"][0]["name"] == "a.pfm");
  CHECK(json["comparisons"][0]["allow_pixels"]["found_percent"] == Approx(100.0 / 96));
  CHECK(json["comparisons"][1]["metrics"]["ssim"] == 1);
  CHECK(json["comparisons"][1]["metrics"].count("flip_hdr") == 0);
  CHECK_THAT(
      read_file(folder / "r.xml"),
      Contains("tests=\"2\" failures=\"1\" errors=\"0\"") &&
          Contains("<failure type=\"beyond the limits\" message=\"max_error is 0.5, allowed at most 0.1\">"));
  const std::string page = read_file(folder / "r.html");
  CHECK_THAT(page, Contains("castray accept image/a.pfm reference/a.pfm") && !Contains("http://") &&
                       !Contains("https://"));
  CHECK(page.find("\"name\":\"a.pfm\"") < page.find("\"name\":\"sub/p.png\""));

  write_file(folder / "reference/gone.pfm", read_file(folder / "a.pfm"));
  const RunResult missing = with({"--junit", "r.xml"});
  CHECK(missing.exit_code == 2);
  CHECK_THAT(missing.out, Contains("ERROR gone.pfm"));
  CHECK_THAT(read_file(folder / "r.xml"),
             Contains("<error type=\"cannot be compared\" message=\"image/gone.pfm: does not exist"));
}

TEST_CASE("limits that cannot be are refused with their place") {
  const Files files;
  const std::vector<std::pair<std::string, std::string>> bad = {
      {"{", "limits.json: "},
      {"[]", "limits.json: must be an object"},
      {R"({"maxx": {}})", "unknown key 'maxx'; did you mean 'max'"},
      {R"({"max": {"mze": 1}})", "there is no metric 'mze'; did you mean 'mse'"},
      {R"({"max": {"mse": "x"}})", "max.mse: must be a number"},
      {R"({"images": {"a.pfm": {"ztest": 2}}})", "a.pfm: ztest: 2 is not a false-alarm rate"},
      {R"({"allow-pixels": "1"})", "give PERCENT:BOUND"},
  };
  for (const auto& [text, says] : bad) {
    write_file(files.folder / "limits.json", text);
    const RunResult result = files.run({"compare", "a.pfm", "a.pfm", "--limits", "limits.json"});
    INFO(text);
    CHECK(result.exit_code == 2);
    CHECK_THAT(result.err, Contains(says));
    CHECK(std::count(result.err.begin(), result.err.end(), '\n') == 1);
  }
  CHECK(files.run({"compare", "a.pfm", "a.pfm", "--min", "ssim=1", "--max", "flip=0"}).exit_code == 0);
  CHECK(files.run({"compare", "b.pfm", "a.pfm", "--min", "ssim=1"}).exit_code == 1);
  CHECK_THAT(files.run({"compare", "a.png", "a.png", "--max", "flip_hdr=1"}).err,
             Contains("no flip_hdr of encoded"));
  CHECK_THAT(files.run({"compare", "a.pfm", "a.pfm", "--ztest", "0.01"}).err,
             Contains("does not tell its noise"));
  CHECK_THAT(files.run({"compare", ".", "a.pfm"}).err, Contains("is a folder, and the other is not"));
}

TEST_CASE("info shows what images and films hold") {
  const Files files;
  write_image(files.folder / "m.png", test_image(12, 8), {},
              {{"castray:scene", "box"}, {"castray:seconds", "1.5"}});
  CHECK_THAT(files.run({"info", "m.png"}).out, Contains("12 x 8") && Contains("castray:scene box") &&
                                                   Contains("castray:seconds 1.5") && Contains("encoded"));
  CHECK_THAT(files.run({"info", "whole.film"}).out,
             Contains("samples    0:7") && Contains("castray:scene test\n"));
  CHECK_THAT(files.run({"info", "nan.pfm"}).out,
             Contains("1 pixels are not finite") && Contains("linear radiance"));
}

TEST_CASE("compare and convert read layers, and say what they leave out") {
  const TemporaryFolder folder;
  const std::string golden = CASTRAY_ROOT "/tests/golden/images/";
  const auto run = [&](std::vector<std::string> arguments) { return run_castray(arguments, folder.path()); };
  const std::string layer = golden + "layer.exr", plain = golden + "plain.exr";
  CHECK(run({"compare", layer, plain, "--layer", "ViewLayer.Combined", "--max", "max_error=0"}).exit_code ==
        0);
  CHECK_THAT(run({"compare", layer, plain, "--layer", "x"}).err,
             Contains("no layer 'x'; its layers are ViewLayer.Combined (R G B A)"));
  CHECK(run({"convert", layer, "--layer", "ViewLayer.Combined", "-o", "c.pfm"}).exit_code == 0);
  CHECK(run({"compare", "c.pfm", plain, "--max", "max_error=0"}).exit_code == 0);
  CHECK(run({"compare", "c.pfm", "c.pfm", "--layer", "x"}).exit_code == 2);
  CHECK(run({"convert", "c.pfm", "--layer", "x", "-o", "d.pfm"}).exit_code == 2);
  CHECK(run({"compare", golden + "xyz_a.exr", golden + "xyz_b.exr", "--max", "max_error=0"}).exit_code == 1);
  const RunResult shifted = run(
      {"compare", golden + "shifted.exr", golden + "full.exr", "--max", "max_error=0", "--json", "r.json"});
  CHECK(shifted.exit_code == 1);
  CHECK_THAT(shifted.out, Contains("shifted.exr: not compared: pixels outside its display window"));
  CHECK(nlohmann::json::parse(read_file(folder / "r.json"))["notes"].size() == 1);
  CHECK_THAT(run({"convert", golden + "shifted.exr", "-o", "d.pfm"}).err,
             Contains("left out: pixels outside its display window"));
}

TEST_CASE("alpha is measured, limited and told") {
  const TemporaryFolder folder;
  const auto run = [&](std::vector<std::string> arguments) { return run_castray(arguments, folder.path()); };
  write_file(folder / "a.png", png_file(1, 8, 6, {std::string("\1\2\3\x66", 4)}));  // alpha .4
  write_file(folder / "b.png", png_file(1, 8, 2, {std::string("\1\2\3", 3)}));
  const RunResult told = run({"compare", "a.png", "b.png", "--max", "max_error=0"});
  CHECK(told.exit_code == 0);
  CHECK_THAT(told.out,
             Contains("alpha              0.6") && Contains("note: alpha differs, and no limit judges it"));
  CHECK(run({"compare", "a.png", "b.png", "--max", "alpha=0.5"}).exit_code == 1);
  CHECK(run({"compare", "a.png", "a.png", "--max", "alpha=0"}).exit_code == 0);
  CHECK(run({"compare", "b.png", "b.png", "--max", "alpha=0"}).exit_code == 0);
  CHECK_THAT(run({"convert", "a.png", "-o", "c.png"}).err, Contains("a.png: left out: alpha"));
  CHECK_THAT(run({"info", "a.png"}).out, Contains("alpha      0.4 .. 0.4, mean 0.4"));
}
