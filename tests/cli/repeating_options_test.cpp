// The options that an image holds are flags that render it again.
#include <catch2/catch.hpp>

#include "castray/image.h"
#include "core/files.h"
#include "run_castray.h"
#include "words.h"

using namespace castray;
using Words = std::vector<std::string>;

namespace {

const std::string scene = CASTRAY_ROOT "/scenes/cornell_box.json";
const std::string with_pilots = CASTRAY_ROOT "/scenes/kinds/bright_neighbour.json";

}  // namespace

TEST_CASE("the options that an image holds are flags that render it again, byte for byte") {
  const TemporaryFolder folder;
  const Words renders[] = {
      {},
      {"--seed", "7", "--sampler", "independent", "--rr", "0.7", "--max-depth", "4", "--reuse", "off"},
      {"--lights", "solid-angle", "--mis", "on", "--jitter", "off", "--crop", "2,3,14,12"},
      {"--samples", "3:5", "--reuse", "8x8:16", "--clamp-indirect", "2", "--exposure", "1", "--bits", "16"},
      {"--integrator", "reference", "--precision", "double", "--epsilon", "0.01"},
      {"--integrator", "reference", "--fault", "skewed-light"},
      {"--reconstruct", "on"},
      {"--reconstruct", "on", "--edge-samples", "2"},
      {"--replicates", "4", "--tone", "gamma:0.6"},
      {"--look-from", "278,273,-500", "--look-at", "278,200,0", "--fov", "60", "--environment", "0.1,0.2,0.3",
       "--two-sided-lights", "--generic", "--accel", "bvh"}};
  for (const Words& given : renders) {
    Words command = {"render", scene,   "-q", "--size", "16x16", "--spp", "8",
                     "-o",     "a.png", "-o", "a.film", "-t",    "2"};
    command.insert(command.end(), given.begin(), given.end());
    REQUIRE(run_castray(command, folder.path()).exit_code == 0);
    const std::string options = read_image(folder / "a.png").metadata.at("castray:options");
    INFO(options);
    Words again = {"render", scene, "-q", "-o", "b.png", "-o", "b.film"};
    for (const std::string& word : words_of(options)) again.push_back(word);
    CHECK(run_castray(again, folder.path()).err == "");
    CHECK(read_file(folder / "a.png") == read_file(folder / "b.png"));
    CHECK(read_file(folder / "a.film") == read_file(folder / "b.film"));
  }
}

TEST_CASE("what pilots decided is told beside the options, which render the image again") {
  const TemporaryFolder folder;
  REQUIRE(run_castray({"render", with_pilots, "-q", "--size", "64x64", "--spp", "4", "-o", "a.png"},
                      folder.path())
              .exit_code == 0);
  const Metadata metadata = read_image(folder / "a.png").metadata;
  CHECK(metadata.at("castray:light-choice") == "learned");
  CHECK(metadata.count("castray:sharing") == 1);
  Words again = {"render", with_pilots, "-q", "-o", "b.png"};
  for (const std::string& word : words_of(metadata.at("castray:options"))) again.push_back(word);
  CHECK(run_castray(again, folder.path()).exit_code == 0);
  CHECK(read_file(folder / "a.png") == read_file(folder / "b.png"));
}
