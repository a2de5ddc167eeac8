#include <catch2/catch.hpp>

#include <nlohmann/json.hpp>

#include "castray/film.h"
#include "core/files.h"
#include "endless_render.h"
#include "run_castray.h"

using namespace castray;
using Catch::Contains;
using test::endless_render;

TEST_CASE("SIGINT, SIGTERM and SIGHUP save what was rendered and exit with 130") {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP})
    for (const char* integrator : {"wavefront", "reference"}) {
      const TemporaryFolder folder;
      const RunResult result =
          run_castray(endless_render({"--stats", "s.json", "--progress", "lines", "--integrator", integrator,
                                      "-o", "x.png", "--checkpoint", "c.film"}),
                      RunSettings{.folder = folder.path(), .signal = signal});
      CHECK(result.exit_code == 130);
      CHECK_THAT(result.err, Contains("stopped early: interrupted"));
      CHECK(folder.names() == std::vector<std::string>{"c.film", "s.json", "x.png"});
      const auto stats = nlohmann::json::parse(read_file(folder / "s.json"));
      CHECK(stats["stopped"] == "interrupted");
      const Film film = read_film(folder / "c.film");
      CHECK(film.count(32, 7) > 0);
      CHECK(stats["spp"] == film.samples_per_pixel());
      CHECK(read_image(folder / "x.png").metadata.at("castray:spp") ==
            samples_text(film.samples_per_pixel()));
      CHECK(film.mean(32, 10).x > 10);  // the light
    }
}

TEST_CASE("without a checkpoint an interrupted image tells its samples too") {
  const TemporaryFolder folder;
  const RunResult result = run_castray(endless_render({"--progress", "lines", "-o", "x.film", "-o", "x.exr"}),
                                       RunSettings{.folder = folder.path(), .signal = SIGINT});
  CHECK(result.exit_code == 130);
  const std::string taken = samples_text(read_film(folder / "x.film").samples_per_pixel());
  CHECK_THAT(result.err, Contains(" pixels, " + taken + " spp"));
  CHECK(read_image(folder / "x.exr").metadata.at("castray:spp") == taken);
  CHECK_THAT(run_castray({"info", "x.film"}, folder.path()).out, Contains("castray:spp " + taken));
}

TEST_CASE("SIGUSR1 writes outputs and checkpoint, and the render goes on") {
  const TemporaryFolder folder;
  CastrayProcess process(endless_render({"--progress", "lines", "-o", "x.film", "--checkpoint", "c.film"}),
                         {.folder = folder.path()});
  process.wait_until([&] { return !process.err().empty(); });
  REQUIRE_FALSE(std::filesystem::exists(folder / "x.film"));
  process.send(SIGUSR1);
  REQUIRE(process.wait_until([&] { return process.err().find("snapshot of") != std::string::npos; }));
  const Film snapshot = read_film(folder / "x.film"), saved = read_film(folder / "c.film");
  CHECK(snapshot.samples_per_pixel() > 0);
  CHECK(snapshot.samples == saved.samples);
  process.send(SIGUSR1);
  CHECK(process.wait_until(
      [&] { return read_film(folder / "x.film").samples_per_pixel() > snapshot.samples_per_pixel(); }));
  CHECK_FALSE(process.ended());
}

TEST_CASE("a preview rewrites the outputs as often as it is asked for") {
  const TemporaryFolder folder;
  CastrayProcess process(endless_render({"-q", "-o", "x.film", "--preview-every", "0.1"}),
                         {.folder = folder.path()});
  REQUIRE(process.wait_until([&] { return std::filesystem::exists(folder / "x.film"); }));
  const double first = read_film(folder / "x.film").samples_per_pixel();
  CHECK(first > 0);
  CHECK(process.wait_until([&] { return read_film(folder / "x.film").samples_per_pixel() > first; }));
  CHECK_FALSE(process.ended());
}
