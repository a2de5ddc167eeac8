#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "core/files.h"
#include "run_castray.h"
#include "test_image.h"

using namespace castray;
using Catch::Contains;

namespace {

/// a.pfm, b.pfm, which differs in the pixels 3,5 and 4,5, and a.png.
struct Files {
  TemporaryFolder folder;

  Files() {
    Image image = test_image(12, 8);
    write_image(folder / "a.pfm", image);
    write_image(folder / "a.png", image);
    image.at(3, 5).y += 0.5f;
    image.at(4, 5).y += 0.25f;
    write_image(folder / "b.pfm", image);
  }
  RunResult run(const std::vector<std::string>& arguments) const {
    return run_castray(arguments, folder.path());
  }
};

}  // namespace

TEST_CASE("compare without limits says that nothing was judged") {
  const Files files;
  const RunResult one = files.run({"compare", "b.pfm", "a.pfm", "--json", "r.json"});
  CHECK(one.exit_code == 0);
  CHECK_THAT(one.out, Contains("no limits were given, so nothing was judged"));
  CHECK(nlohmann::json::parse(read_file(files.folder / "r.json"))["judged"] == false);
  CHECK_THAT(files.run({"compare", "b.pfm", "a.pfm", "--max", "mse=1"}).out, !Contains("nothing was judged"));
  for (const char* side : {"images", "references"}) {
    std::filesystem::create_directory(files.folder / side);
    write_image(files.folder / side / "a.pfm", test_image(2, 2));
  }
  const RunResult folders = files.run({"compare", "images", "references"});
  CHECK(folders.exit_code == 0);
  CHECK_THAT(folders.out, Contains("nothing was judged") && !Contains("pass"));
  CHECK_THAT(folders.out, Contains("images 1 image, 0.01 MB, references 1 image, 0.01 MB"));
}

TEST_CASE("what does not exist, and what is no number, is said so") {
  const Files files;
  std::filesystem::create_directory(files.folder / "folder");
  const std::pair<std::vector<std::string>, const char*> all[] = {
      {{"compare", "gone", "folder"}, "gone: does not exist\n"},
      {{"compare", "gone.pfm", "a.pfm"}, "gone.pfm: does not exist\n"},
      {{"compare", "a.pfm", "gone.pfm"},
       "gone.pfm: does not exist; 'castray accept' makes references of images\n"},
      {{"accept", "gone", "folder"}, "gone: does not exist\n"},
      {{"compare", "a.pfm", "a.pfm", "--exposure", "abc"}, "--exposure 'abc': must be a number\n"},
      {{"compare", "a.pfm", "a.pfm", "--ztest", "x"}, "--ztest 'x': must be a number\n"},
      {{"convert", "a.pfm", "-o", "c.png", "--exposure", "1,5"}, "--exposure '1,5': must be a number\n"}};
  for (const auto& [arguments, says] : all) {
    const RunResult result = files.run(arguments);
    CHECK(result.exit_code == 2);
    CHECK(result.err == std::string("castray: error: ") + says);
  }
}

TEST_CASE("a gamma above 1, which darkens, is said to") {
  const Files files;
  CHECK_THAT(files.run({"convert", "a.pfm", "-o", "c.png", "--tone", "gamma:2.2"}).err,
             Contains("value^2.2 darkens") && Contains("gamma:0.4545"));
  CHECK(files.run({"convert", "a.pfm", "-o", "c.png", "--tone", "gamma:0.6"}).err.empty());
}

TEST_CASE("images and reports go to the standard output") {
  const Files files;
  CHECK(files.run({"convert", "a.pfm", "-o", "-"}).out == read_file(files.folder / "a.png"));
  CHECK(files.run({"convert", "a.pfm", "-o", "/dev/stdout"}).out == read_file(files.folder / "a.png"));
  CHECK(files.run({"convert", "a.png", "-o", "a.exr"}).exit_code == 0);
  CHECK(files.run({"convert", "a.png", "-o", "exr:-"}).out == read_file(files.folder / "a.exr"));
  CHECK(files.run({"convert", "b.pfm", "-o", "pfm:-"}).out == read_file(files.folder / "b.pfm"));
  CHECK_THAT(files.run({"convert", "b.pfm", "-o", "tif:-"}).err, Contains("unknown image format '.tif'"));
  const RunResult json = files.run({"compare", "b.pfm", "a.pfm", "--json", "-"});
  CHECK(nlohmann::json::parse(json.out)["metrics"]["max_error"] == Approx(0.5));
  CHECK_THAT(json.err, Contains("max_error"));
  CHECK(files.folder.names() == std::vector<std::string>{"a.exr", "a.pfm", "a.png", "b.pfm"});
}

TEST_CASE("what cannot be written to the standard output is an error") {
  const Files files;
  for (const std::vector<std::string>& arguments :
       std::initializer_list<std::vector<std::string>>{{"compare", "a.pfm", "b.pfm"},
                                                       {"info", "a.pfm"},
                                                       {"--help"},
                                                       {"convert", "a.pfm", "-o", "-"},
                                                       {"compare", "a.pfm", "b.pfm", "--json", "-"}}) {
    const RunResult result =
        run_castray(arguments, RunSettings{.folder = files.folder.path(), .output_file = "/dev/full"});
    INFO(arguments.front());
    CHECK(result.exit_code == 2);
    CHECK_THAT(result.err, Contains("cannot be written") && Contains("No space left on device"));
  }
}

TEST_CASE("two renders give the same bytes in every format, unless --metadata time is given") {
  const TemporaryFolder folder;
  const std::string scene = CASTRAY_ROOT "/scenes/cornell_box.json";
  const std::vector<std::string> names = {"x.ppm", "x.png", "x.pfm", "x.hdr", "x.exr", "x.film"};
  const auto render = [&](const std::string& side, const std::vector<std::string>& more) {
    std::filesystem::create_directory(folder / side);
    std::vector<std::string> arguments = {"render", scene, "-q", "--size", "8x6", "--spp", "4"};
    for (const std::string& name : names) arguments.insert(arguments.end(), {"-o", side + "/" + name});
    arguments.insert(arguments.end(), more.begin(), more.end());
    CHECK(run_castray(arguments, folder.path()).exit_code == 0);
  };
  render("a", {"--threads", "1"});
  render("b", {"--threads", "2"});
  for (const std::string& name : names) {
    INFO(name);
    CHECK(read_file(folder / "a" / name) == read_file(folder / "b" / name));
  }
  render("c", {"--metadata", "time"});
  for (const char* name : {"x.png", "x.exr"}) {
    CHECK(read_image(folder / "a" / name).metadata.count("castray:seconds") == 0);
    CHECK(std::stod(read_image(folder / "c" / name).metadata.at("castray:seconds")) >= 0);
  }
}

TEST_CASE("the comparison page embeds passing images small, and marks where others differ most") {
  const Files files;
  const auto& folder = files.folder;
  for (const char* side : {"images", "references"}) {
    std::filesystem::create_directory(folder / side);
    write_image(folder / side / "same.pfm", test_image(300, 200));
    write_file(folder / side / "z.pfm",
               read_file(folder / (side == std::string("images") ? "b.pfm" : "a.pfm")));
  }
  CHECK(files.run({"compare", "images", "references", "--max", "max_error=0.1", "--html", "r.html"})
            .exit_code == 1);
  const std::string page = read_file(folder / "r.html");
  const std::size_t begin = page.find("id=\"data\">") + 10;
  const auto items =
      nlohmann::json::parse(page.substr(begin, page.find("</script>", begin) - begin))["items"];
  CHECK(items[0]["worst"] == nlohmann::json{3, 5, 4, 6});
  CHECK(items[0].contains("reference"));
  CHECK(items[1]["verdict"] == "pass");
  CHECK_FALSE(items[1].contains("reference"));
  const std::string thumbnail = items[1]["thumbnail"];
  CHECK_THAT(thumbnail, Catch::StartsWith("data:image/png;base64,"));
  CHECK(thumbnail.size() < 300 * 200);  // 150x100 of the whole's 300x200 pixels
  CHECK(files.run({"compare", "a.pfm", "a.pfm", "--max", "mse=0", "--html", "whole.html"}).exit_code == 0);
  CHECK_THAT(read_file(folder / "whole.html"), !Contains("\"thumbnail\":") && Contains("\"reference\":\""));
}
