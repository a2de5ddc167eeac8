#include <catch2/catch.hpp>

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

/// A render of the Cornell box, whose scene file says 64 spp, in 16x16 pixels.
Outcome render_for(const TemporaryFolder& folder, const std::vector<std::string>& more) {
  std::vector<std::string> arguments{"render",  CASTRAY_ROOT "/scenes/cornell_box.json",
                                     "--size",  "16x16",
                                     "-o",      "x.film",
                                     "-o",      "x.png",
                                     "-o",      "x.exr",
                                     "--stats", "s.json"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  Outcome outcome{run_castray(arguments, folder.path()), {}};
  outcome.stats = nlohmann::json::parse(read_file(folder / "s.json"));
  return outcome;
}

}  // namespace

TEST_CASE(
    "a time limit alone is what was asked for: the scene's spp is no limit, every output tells what was "
    "taken") {
  const TemporaryFolder folder;
  const Outcome o = render_for(folder, {"--time-limit", "3", "--threads", "1"});
  CHECK(o.run.exit_code == 0);
  CHECK(o.stats["stopped"] == "time-limit");
  CHECK(o.stats["spp"] > 64);
  const double taken = read_film(folder / "x.film").samples_per_pixel();
  CHECK(o.stats["spp"] == taken);
  CHECK(o.stats["paths"] >= 0.95 * taken * 16 * 16);  // and those that the stop discards
  CHECK_THAT(o.run.err, Contains(" pixels, " + samples_text(taken) + " spp") && Contains("Render complete"));
  for (const char* file : {"x.png", "x.exr", "x.film"})
    CHECK(read_image(folder / file).metadata.at("castray:spp") == samples_text(taken));
}

TEST_CASE("a time limit that ends a render of so many samples says so and exits with 1") {
  const TemporaryFolder folder;
  for (const char* integrator : {"wavefront", "reference"}) {
    const Outcome o =
        render_for(folder, {"--time-limit", "0.3", "--spp", "4000000000", "--integrator", integrator});
    CHECK(o.run.exit_code == 1);
    CHECK_THAT(o.run.err, Contains("stopped early: time-limit") && !Contains("Render complete"));
    CHECK(o.stats["stopped"] == "time-limit");
  }
}

TEST_CASE("samples that are done before the time limit end the render") {
  const TemporaryFolder folder;
  const Outcome o = render_for(folder, {"--time-limit", "100", "--spp", "3"});
  CHECK(o.run.exit_code == 0);
  CHECK(o.stats["stopped"] == "done");
  CHECK(o.stats["spp"] == 3);
  CHECK(o.stats["paths"] == 3 * 16 * 16);
}

TEST_CASE("however short the time, every pixel has a sample") {
  const TemporaryFolder folder;
  const Outcome o = render_for(folder, {"--time-limit", "1e-9"});
  CHECK(o.run.exit_code == 0);
  const Film film = read_film(folder / "x.film");
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 16; ++x) CHECK(film.count(x, y) > 0);
}

TEST_CASE("a render ended by its time limit is resumed from its checkpoint to the same bytes") {
  const TemporaryFolder folder;
  const Outcome part = render_for(folder, {"--time-limit", "0.2", "--checkpoint", "c.film"});
  CHECK(part.run.exit_code == 0);
  const std::uint64_t taken = read_film(folder / "c.film").samples.at(0).count;
  const std::string spp = std::to_string(taken + 5);
  REQUIRE(render_for(folder, {"--spp", spp, "--checkpoint", "c.film", "--resume"}).run.exit_code == 0);
  const std::string resumed = read_file(folder / "x.film");
  REQUIRE(render_for(folder, {"--spp", spp}).run.exit_code == 0);
  CHECK(read_file(folder / "x.film") == resumed);
}
