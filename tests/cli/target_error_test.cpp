#include <catch2/catch.hpp>

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "castray/film.h"
#include "core/files.h"
#include "run_castray.h"

using namespace castray;
using Catch::Contains;

namespace {

struct Outcome {
  RunResult run;
  nlohmann::json stats;
};

/// A render of the Cornell box, whose scene file says 64 spp, in 48x48 pixels.
Outcome render_to(const TemporaryFolder& folder, const std::vector<std::string>& more) {
  std::vector<std::string> arguments{
      "render", CASTRAY_ROOT "/scenes/cornell_box.json", "--size", "48x48", "-o", "x.pfm", "--stats",
      "s.json"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  Outcome outcome{run_castray(arguments, folder.path()), {}};
  outcome.stats = nlohmann::json::parse(read_file(folder / "s.json"));
  return outcome;
}

}  // namespace

TEST_CASE("a render stops where its target error is reached, and says so") {
  const TemporaryFolder folder;
  const Outcome o = render_to(folder, {"--target-error", "1e-3", "-o", "x.png"});
  CHECK(o.run.exit_code == 0);
  const double expected = o.stats["expected_error"];
  CHECK_THAT(o.run.err, Contains(fmt::format("relMSE about {:.2g}, the target was 0.001\n", expected)) &&
                            Contains("Render complete"));
  CHECK(o.stats["stopped"] == "target-error");
  CHECK(o.stats["target_error"] == 1e-3);
  CHECK(o.stats["expected_error"] <= 1.4e-3);
  CHECK(o.stats["expected_error"] > 0.4e-3);
  CHECK(o.stats["pilot_paths"] > 0);
  CHECK(o.stats["paths"] > o.stats["pilot_paths"]);
  CHECK(o.stats["spp"] > 1);
  const auto metadata = read_image(folder / "x.png").metadata;
  CHECK(metadata.at("castray:spp") == samples_text(o.stats["spp"]));
  CHECK_THAT(metadata.at("castray:options"), Contains("--target-error 0.001"));
}

TEST_CASE("the scene's spp does not limit a target error, --spp does") {
  const TemporaryFolder folder;
  const Outcome free = render_to(folder, {"--target-error", "1e-4"});
  CHECK(free.run.exit_code == 0);
  CHECK(free.stats["spp"] > 64);
  const Outcome limited = render_to(folder, {"--target-error", "1e-4", "--spp", "8"});
  CHECK(limited.run.exit_code == 1);
  CHECK_THAT(limited.run.err, Contains("the target of 0.0001 was not reached") && Contains("--spp") &&
                                  !Contains("Render complete"));
  CHECK(limited.stats["stopped"] == "done");
  CHECK(limited.stats["spp"] == 8);
  CHECK(limited.stats["expected_error"] > 1e-4);
}

TEST_CASE("a time limit ends a render to a target error with a whole image") {
  const TemporaryFolder folder;
  for (const char* limit : {"1e-9", "0.5"}) {
    const Outcome o = render_to(folder, {"--target-error", "1e-7", "--time-limit", limit});
    CHECK(o.run.exit_code == 1);
    CHECK(o.stats["stopped"] == "time-limit");
    CHECK_THAT(o.run.err, Contains("stopped early: time-limit"));
    CHECK(read_image(folder / "x.pfm").image.at(24, 7).x > 10);  // the light
  }
}

TEST_CASE("a film to a target error is of its own kind") {
  const TemporaryFolder folder;
  REQUIRE(render_to(folder, {"--target-error", "1e-2", "-o", "a.film"}).run.exit_code == 0);
  REQUIRE(render_to(folder, {"--samples", "1000:1", "-o", "b.film"}).run.exit_code == 0);
  const RunResult merged = run_castray({"merge", "a.film", "b.film", "-o", "c.film"}, folder.path());
  CHECK(merged.exit_code == 2);
  CHECK_THAT(merged.err, Contains("target-error=0.01"));
}
