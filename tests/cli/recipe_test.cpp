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

// In a folder that looks like a checkout, where ./run is the program that is built already.
TEST_CASE("the workflow in README renders and compares, and accepting makes it pass") {
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
  REQUIRE(steps.size() == 2);
  CHECK(shell("sh -ec '" + steps[0] + "'") == 0);
  CHECK(shell(steps[1]) == 2);
  CHECK_THAT(read_file(checkout / "log"), Catch::Contains("references: does not exist; 'castray accept'"));
  CHECK(shell("./run accept out references") == 0);
  CHECK(shell(steps[1]) == 0);
  CHECK_THAT(read_file(checkout / "log"), Catch::Contains("3 of 3 images pass"));
  CHECK(std::filesystem::exists(checkout / "page.html"));
  CHECK(std::filesystem::exists(checkout / "junit.xml"));
  CHECK(shell("./run render scenes/cornell_lights.json --size 128x128 --replicates 16 -o "
              "references/cornell_box.film") == 0);
  CHECK(shell(steps[1]) == 1);
}
