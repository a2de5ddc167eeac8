#include <catch2/catch.hpp>
#include <cstdlib>

#include "core/files.h"
#include "temporary_folder.h"

using namespace castray;

namespace {

/// The commands of the workflow in README, line by line.
std::vector<std::string> steps_of_workflow() {
  const std::string readme = read_file(CASTRAY_ROOT "/README.md");
  std::vector<std::string> steps;
  constexpr std::string_view mark = "- run: ";
  for (std::size_t at = readme.find(mark); at != std::string::npos; at = readme.find(mark, at + 1))
    steps.push_back(readme.substr(at + mark.size(), readme.find('\n', at) - at - mark.size()));
  return steps;
}

}  // namespace

TEST_CASE("the workflow in README keeps the page, JUnit's file and the references, also after a failure") {
  const std::string readme = read_file(CASTRAY_ROOT "/README.md");
  const std::size_t upload = readme.find("uses: actions/upload-artifact");
  REQUIRE(upload != readme.npos);
  const std::string step = readme.substr(upload, readme.find("```", upload) - upload);
  for (const char* part : {"if: always()", "page.html", "junit.xml", "references"})
    CHECK_THAT(step, Catch::Contains(part));
}

// In a folder that looks like a checkout, where ./run is the program that is built already.
TEST_CASE("the workflow in README renders, makes the references it does not have, and compares") {
  const TemporaryFolder checkout;
  std::filesystem::create_directory_symlink(CASTRAY_ROOT "/scenes", checkout / "scenes");
  std::filesystem::create_directory_symlink(CASTRAY_ROOT "/models", checkout / "models");
  std::filesystem::create_symlink(CASTRAY_PROGRAM, checkout / "run");
  const auto shell = [&](const std::string& command) {
    const int status =
        std::system(("cd '" + checkout.path().string() + "' && { " + command + "; } >log 2>&1").c_str());
    INFO(read_file(checkout / "log"));
    REQUIRE(WIFEXITED(status));
    return WEXITSTATUS(status);
  };
  const std::vector<std::string> steps = steps_of_workflow();
  REQUIRE(steps.size() == 3);
  const std::string &render = steps[0], &make_references = steps[1], &compare = steps[2];
  CHECK(shell("sh -ec '" + render + "'") == 0);
  CHECK(shell(compare) == 2);
  CHECK_THAT(read_file(checkout / "log"), Catch::Contains("references: does not exist; 'castray accept'"));
  CHECK(shell(make_references) == 0);
  CHECK_THAT(read_file(checkout / "log"), Catch::Contains("new       references/furnace.exr"));
  CHECK(shell(make_references) == 0);
  CHECK(read_file(checkout / "log") == "");  // what is there stays
  CHECK(shell(compare) == 0);
  CHECK_THAT(read_file(checkout / "log"), Catch::Contains("3 of 3 images pass"));
  CHECK(std::filesystem::exists(checkout / "page.html"));
  CHECK(std::filesystem::exists(checkout / "junit.xml"));
  CHECK(shell("./run render scenes/cornell_lights.json --size 128x128 --replicates 16 --bits 16 -o "
              "references/cornell_box.exr") == 0);
  CHECK(shell(compare) == 1);
}
