// Images from differences, as the command line makes them.
#include <catch2/catch.hpp>

#include "castray/image.h"
#include "core/files.h"
#include "run_castray.h"

using namespace castray;
using Words = std::vector<std::string>;

namespace {

const std::string box = CASTRAY_ROOT "/scenes/cornell_box.json";

Words render(const Words& more) {
  Words words = {"render", box, "-q", "--size", "48x40", "--seed", "3", "--reconstruct", "on"};
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

}  // namespace

TEST_CASE("render, merge, convert and compare make the same image of the same film") {
  const TemporaryFolder folder;
  const auto run = [&](const Words& words) { return run_castray(words, folder.path()); };
  REQUIRE(run(render({"--spp", "8", "-t", "1", "-o", "a.pfm", "-o", "a.film"})).exit_code == 0);
  REQUIRE(run(render({"--samples", "0:3", "-t", "3", "-o", "1.film"})).exit_code == 0);
  REQUIRE(run(render({"--samples", "3:5", "-o", "2.film"})).exit_code == 0);
  REQUIRE(run({"merge", "2.film", "1.film", "-o", "m.film", "-o", "m.pfm"}).exit_code == 0);
  REQUIRE(run(render({"--spp", "3", "--checkpoint", "k.film"})).exit_code == 0);
  REQUIRE(run(render({"--spp", "8", "--checkpoint", "k.film", "--resume", "-o", "r.pfm"})).exit_code == 0);
  CHECK(read_file(folder / "r.pfm") == read_file(folder / "a.pfm"));
  REQUIRE(run({"convert", "a.film", "-o", "c.pfm"}).exit_code == 0);
  const std::string image = read_file(folder / "a.pfm");
  CHECK(read_file(folder / "m.film") == read_file(folder / "a.film"));
  CHECK(read_file(folder / "m.pfm") == image);
  CHECK(read_file(folder / "c.pfm") == image);
  CHECK(run({"compare", "a.film", "m.pfm", "--max", "mse=0"}).exit_code == 0);
  CHECK_THAT(run({"info", "a.film"}).out, Catch::Contains("means and differences"));
}

TEST_CASE("without reconstruction a film has no differences, and an image is the means") {
  const TemporaryFolder folder;
  const auto size_of = [&](const Words& more, const std::string& scene = box) {
    Words words = {"render", scene, "-q", "--size", "48x40", "--spp", "4", "-o", "a.film"};
    words.insert(words.end(), more.begin(), more.end());
    REQUIRE(run_castray(words, folder.path()).exit_code == 0);
    return std::filesystem::file_size(folder / "a.film");
  };
  constexpr std::size_t pixels = 48 * 40;
  const std::string outdoors = CASTRAY_ROOT "/scenes/kinds/sky_and_ground.json";
  CHECK(size_of({"--reconstruct", "on"}) > 220 * pixels);
  CHECK(size_of({"--reconstruct", "on"}, outdoors) > 220 * pixels);
  for (const Words& plain : {Words{}, Words{"--reuse", "off"}, Words{"--reconstruct", "off"}})
    CHECK(size_of(plain) < 53 * pixels + 1000);
}

TEST_CASE("by default the box is reconstructed, parts and resumed renders too, which the log tells") {
  const TemporaryFolder folder;
  const auto run = [&](const Words& more) {
    Words words = {"render", box, "--size", "192x192"};
    words.insert(words.end(), more.begin(), more.end());
    return run_castray(words, folder.path());
  };
  const RunResult whole = run({"--spp", "4", "-o", "a.pfm", "-o", "a.film"});
  CHECK_THAT(whole.err, Catch::Contains("image from differences of pixels (by a pilot"));
  CHECK_THAT(run_castray({"info", "a.film"}, folder.path()).out, Catch::Contains("means and differences"));
  REQUIRE(run({"--spp", "4", "-q", "--reconstruct", "off", "-o", "off.pfm"}).exit_code == 0);
  CHECK(read_file(folder / "off.pfm") != read_file(folder / "a.pfm"));
  REQUIRE(run({"--spp", "4", "-q", "--part", "0/2", "-o", "p{part}.film"}).exit_code == 0);
  REQUIRE(run({"--spp", "4", "-q", "--part", "1/2", "-o", "p{part}.film"}).exit_code == 0);
  REQUIRE(
      run_castray({"merge", "p0.film", "p1.film", "-o", "m.film", "-o", "m.pfm"}, folder.path()).exit_code ==
      0);
  CHECK(read_file(folder / "m.film") == read_file(folder / "a.film"));
  CHECK(read_file(folder / "m.pfm") == read_file(folder / "a.pfm"));
  REQUIRE(run({"--spp", "2", "-q", "--replicates", "2", "-o", "r.film"}).exit_code == 0);
  CHECK_THAT(run_castray({"info", "r.film"}, folder.path()).out, !Catch::Contains("means and differences"));
}

TEST_CASE("films with other numbers of samples at edges are not merged") {
  const TemporaryFolder folder;
  const auto run = [&](const Words& words) { return run_castray(words, folder.path()); };
  REQUIRE(run(render({"--samples", "0:2", "-o", "a.film"})).exit_code == 0);
  REQUIRE(run(render({"--samples", "2:2", "--edge-samples", "2", "-o", "b.film"})).exit_code == 0);
  REQUIRE(run(render({"--samples", "2:2", "--edge-samples", "3", "-o", "c.film"})).exit_code == 0);
  const RunResult refused = run({"merge", "a.film", "b.film", "-o", "m.film"});
  CHECK(refused.exit_code == 2);
  CHECK_THAT(refused.err, Catch::Contains("edge-samples=2 against edge-samples=3"));
  CHECK(run({"merge", "a.film", "c.film", "-o", "m.film"}).exit_code == 0);
}

TEST_CASE("numbers of samples at edges that cannot be are refused") {
  const auto refused = [](const Words& more, const std::string& words) {
    Words command = {"render", box, "-q", "--size", "48x40", "-o", "x.pfm", "--edge-samples"};
    command.insert(command.end(), more.begin(), more.end());
    const RunResult result = run_castray(command);
    CHECK(result.exit_code == 2);
    CHECK(result.error_lines() == 1);
    CHECK_THAT(result.err, Catch::Contains("--edge-samples") && Catch::Contains(words));
  };
  refused({"0"}, "between 1 and 8");
  refused({"9"}, "between 1 and 8");
  refused({"2", "--reconstruct", "off"}, "leave out --reconstruct off");
  refused({"2", "--reuse", "off"}, "leave out --reuse off");
  refused({"2", "--integrator", "reference"}, "the reference integrator");
  refused({"2", "--replicates", "2", "--spp", "4"}, "cannot go with --replicates");
}

TEST_CASE("reconstruction is refused where there is nothing to reconstruct from") {
  const auto refused = [](const Words& more, const std::string& words) {
    Words command = {"render", box, "-q", "--size", "48x40", "--reconstruct", "on", "-o", "x.pfm"};
    command.insert(command.end(), more.begin(), more.end());
    const RunResult result = run_castray(command);
    CHECK(result.exit_code == 2);
    CHECK(result.error_lines() == 1);
    CHECK_THAT(result.err, Catch::Contains("--reconstruct on") && Catch::Contains(words));
  };
  refused({"--reuse", "off"}, "leave out --reuse off");
  refused({"--integrator", "reference"}, "the reference integrator");
  refused({"--replicates", "2", "--spp", "4"}, "--replicates");
}
