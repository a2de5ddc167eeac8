#include <catch2/catch.hpp>

#include <filesystem>

#include "run_castray.h"

using Catch::Contains;

namespace {

RunResult render(const TemporaryFolder& folder, const std::vector<std::string>& more) {
  std::vector<std::string> arguments{"render", CASTRAY_ROOT "/scenes/cornell_box.json", "--spp", "1", "-o",
                                     "x.pfm"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return run_castray(arguments, folder.path());
}

}  // namespace

TEST_CASE("a film larger than the memory limit is refused before it is taken, with what it needs") {
  const TemporaryFolder folder;
  const RunResult result = render(folder, {"--size", "16384x16384", "--memory-limit", "2G"});
  CHECK(result.exit_code == 2);
  CHECK_THAT(result.err, Contains("--memory-limit of 2.00 GiB: more is needed") &&
                             Contains("at least 13.00 GiB for the film") && Contains("--crop"));
  CHECK(result.peak_kilobytes < 200 * 1024);
  CHECK_FALSE(std::filesystem::exists(folder / "x.pfm"));
}

TEST_CASE("a band of an image that is too large renders within the limit") {
  const TemporaryFolder folder;
  const RunResult result =
      render(folder, {"--size", "16384x16384", "--crop", "0,8192,16384,8200", "--memory-limit", "1G"});
  CAPTURE(result.err);
  CHECK(result.exit_code == 0);
  CHECK(result.peak_kilobytes < 1024 * 1024);
}

TEST_CASE("what goes beyond the limit while it renders is one line, not a killed process") {
  const TemporaryFolder folder;
  const RunResult result = render(folder, {"--size", "1024x1024", "--memory-limit", "62M", "-q"});
  CHECK(result.exit_code == 2);
  CHECK(result.error_lines() == 1);
  CHECK_THAT(result.err, Contains("memory"));
}

TEST_CASE("the log tells the memory that is needed, sizes have units") {
  const TemporaryFolder folder;
  CHECK_THAT(render(folder, {"--size", "64x64", "-v"}).err,
             Contains("castray: memory: ") && Contains("for the film"));
  CHECK(render(folder, {"--size", "8x8", "--memory-limit", "4294967296"}).exit_code == 0);
  CHECK_THAT(render(folder, {"--memory-limit", "1T"}).err, Contains("--memory-limit '1T'"));
  CHECK(render(folder, {"--memory-limit", "0"}).exit_code == 2);
}
