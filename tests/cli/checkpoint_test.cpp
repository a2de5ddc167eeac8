#include <catch2/catch.hpp>

#include <fmt/format.h>

#include <random>
#include <utility>

#include "castray/film.h"
#include "core/files.h"
#include "run_castray.h"

using namespace castray;
using Catch::Contains;

namespace {

/// A render of the Cornell box in 48x48 pixels, with `c.film` as its checkpoint.
std::vector<std::string> checkpointed(std::vector<std::string> more) {
  std::vector<std::string> arguments{
      "render", CASTRAY_ROOT "/scenes/cornell_box.json", "--size", "48x48", "--checkpoint", "c.film"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

RunResult render_checkpointed(const TemporaryFolder& folder, const std::vector<std::string>& more) {
  return run_castray(checkpointed(more), folder.path());
}

/// The film of a render without a checkpoint.
std::string uninterrupted(const std::string& spp) {
  const TemporaryFolder folder;
  const RunResult result = run_castray({"render", CASTRAY_ROOT "/scenes/cornell_box.json", "--size", "48x48",
                                        "--spp", spp, "-o", "x.film", "-q"},
                                       folder.path());
  REQUIRE(result.exit_code == 0);
  return read_file(folder / "x.film");
}

/// The same render with its checkpoint, ended by SIGKILL `kills` times, each time after a random while, and
/// resumed until it is done: x.film. Returns how often it was ended before its end.
int render_killed(const TemporaryFolder& folder, const std::string& spp, int kills, unsigned seed) {
  std::mt19937 random(seed);
  int ended = 0;
  for (int kill = 0; kill < kills; ++kill) {
    CastrayProcess process(
        checkpointed({"--spp", spp, "--checkpoint-every", "0", "--resume", "-o", "x.film", "-q"}),
        {.folder = folder.path()});
    usleep(std::uniform_int_distribution<useconds_t>(1000, 200000)(random));
    process.send(SIGKILL);
    const RunResult result = process.wait();
    REQUIRE((result.exit_code == 128 + SIGKILL || result.exit_code == 0));
    ended += result.exit_code != 0;
    for (const char* file : {"c.film", "c.previous.film"})
      if (std::filesystem::exists(folder / file)) CHECK_NOTHROW(read_film(folder / file));
  }
  const RunResult last = render_checkpointed(folder, {"--spp", spp, "--resume", "-o", "x.film", "-q"});
  CAPTURE(last.err);
  REQUIRE(last.exit_code == 0);
  return ended;
}

}  // namespace

TEST_CASE("outputs that cannot be written cost none of the others") {
  const TemporaryFolder folder;
  RunSettings settings{.folder = folder.path(), .largest_file = 100000};  // a film has 900 000 bytes
  const RunResult result = run_castray(checkpointed({"--spp", "8", "--checkpoint-every", "0", "-o", "x.film",
                                                     "-o", "x.png", "--progress", "off"}),
                                       settings);
  CHECK(result.exit_code == 2);
  CHECK_THAT(result.err, Contains("castray: warning: c.film: cannot be written") &&
                             Contains("castray: error: x.film: cannot be written"));
  CHECK(std::filesystem::exists(folder / "x.png"));
  CHECK_FALSE(std::filesystem::exists(folder / "c.film"));
}

TEST_CASE("a render killed at random moments and resumed ends with the same bytes") {
  const TemporaryFolder folder;
  CHECK(render_killed(folder, "600", 6, 1) > 0);
  CHECK(read_file(folder / "x.film") == uninterrupted("600"));
}

TEST_CASE("a render killed at 50 random moments and resumed ends with the same bytes", "[long]") {
  const TemporaryFolder folder;
  CHECK(render_killed(folder, "20000", 50, 2) > 40);
  CHECK(read_file(folder / "x.film") == uninterrupted("20000"));
}

TEST_CASE("a checkpoint is resumed to the same bytes, with more samples too, and the log says from where") {
  const TemporaryFolder folder;
  REQUIRE(render_checkpointed(folder, {"--spp", "5", "-o", "x.pfm", "-q"}).exit_code == 0);
  const RunResult resumed = render_checkpointed(folder, {"--spp", "12", "-o", "x.film", "--resume"});
  CHECK(resumed.exit_code == 0);
  CHECK_THAT(resumed.err, Contains("going on from c.film: 5 of 12 samples per pixel are there"));
  CHECK(read_file(folder / "x.film") == uninterrupted("12"));
  CHECK(read_file(folder / "c.film") == read_file(folder / "x.film"));
}

TEST_CASE("a checkpoint that is there is not overwritten unless it is resumed") {
  const TemporaryFolder folder;
  for (const char* name : {"c.film", "c.previous.film"}) {
    write_file(folder / name, "precious");
    const RunResult result = render_checkpointed(folder, {"--spp", "1", "-o", "x.film"});
    CHECK(result.exit_code == 2);
    CHECK_THAT(result.err, Contains(fmt::format("{}: is there already", name)) && Contains("--resume"));
    CHECK(folder.names() == std::vector<std::string>{name});
    CHECK(read_file(folder / name) == "precious");
    std::filesystem::remove(folder / name);
  }
  const RunResult anew = render_checkpointed(folder, {"--spp", "1", "--resume", "-o", "x.film"});
  CHECK(anew.exit_code == 0);  // nothing to resume from yet
  CHECK_THAT(anew.err, !Contains("going on"));
}

TEST_CASE("the checkpoint before the last is kept, and resumed where the last one is damaged or missing") {
  const TemporaryFolder folder;
  REQUIRE(
      render_checkpointed(folder, {"--spp", "5", "--checkpoint-every", "0", "-o", "x.pfm", "-q"}).exit_code ==
      0);
  REQUIRE(render_checkpointed(folder, {"--spp", "7", "--resume", "-o", "x.pfm", "-q"}).exit_code == 0);
  CHECK(read_film(folder / "c.film").samples == std::vector<SampleRange>{{0, 7}});
  const std::string whole = read_file(folder / "c.film"), before = read_file(folder / "c.previous.film");
  CHECK(read_film(folder / "c.previous.film").samples == std::vector<SampleRange>{{0, 5}});

  std::string flipped = whole;
  flipped[whole.size() / 2] ^= 1;
  for (const std::string& damaged : {flipped, whole.substr(0, whole.size() / 2), std::string()}) {
    write_file(folder / "c.film", damaged);
    write_file(folder / "c.previous.film", before);
    if (damaged.empty()) std::filesystem::remove(folder / "c.film");
    const RunResult result = render_checkpointed(folder, {"--spp", "12", "--resume", "-o", "x.film"});
    CHECK(result.exit_code == 0);
    CHECK_THAT(result.err, Contains("warning: c.film: ") && Contains("going on from c.previous.film"));
    CHECK(read_file(folder / "x.film") == uninterrupted("12"));
  }

  write_file(folder / "c.film", flipped);
  std::filesystem::remove(folder / "c.previous.film");
  const RunResult lost = render_checkpointed(folder, {"--spp", "12", "--resume", "-o", "x.film"});
  CHECK(lost.exit_code == 2);
  CHECK_THAT(lost.err, Contains("c.film: is corrupt: its checksum is wrong"));
  CHECK(read_file(folder / "c.film") == flipped);
}

TEST_CASE("a checkpoint of another scene, other options, version or samples is refused by name") {
  const TemporaryFolder folder;
  REQUIRE(render_checkpointed(folder, {"--spp", "4", "-o", "x.pfm", "-q"}).exit_code == 0);
  const auto refused = [&](const std::vector<std::string>& more, const std::string& difference) {
    const std::string before = read_file(folder / "c.film");
    const RunResult result = render_checkpointed(folder, more);
    CHECK(result.exit_code == 2);
    CHECK_THAT(result.err, Contains("another render") && Contains(difference));
    CHECK(read_file(folder / "c.film") == before);
  };
  refused({"--spp", "8", "--resume", "--seed", "3"}, "seed=0 against seed=3");
  refused({"--spp", "8", "--resume", "--max-depth", "2"}, "max-depth=none against max-depth=2");
  refused({"--spp", "8", "--resume", "--crop", "0,0,8,8"}, "another crop");
  refused({"--spp", "3", "--resume"}, "its samples are 0:4, and 0:3 are asked for");
  refused({"--samples", "4:4", "--resume"}, "its samples are 0:4, and 4:4 are asked for");
  const RunResult other = run_castray({"render", CASTRAY_ROOT "/scenes/furnace.json", "--size", "48x48",
                                       "--checkpoint", "c.film", "--resume"},
                                      folder.path());
  CHECK(other.exit_code == 2);
  CHECK_THAT(other.err, Contains("scene=cornell_box, hash=") && Contains("against scene=furnace, hash="));

  Film film = read_film(folder / "c.film");
  const std::string own = std::exchange(film.version, "0.0.1");
  write_film(folder / "c.film", film);
  refused({"--spp", "8", "--resume"}, "castray 0.0.1 against castray " + own);
}
