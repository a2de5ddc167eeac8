#include <catch2/catch.hpp>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "castray/image.h"
#include "core/files.h"
#include "run_castray.h"

using namespace castray;
using Catch::Contains;

namespace {

const std::string cornell = CASTRAY_ROOT "/scenes/cornell_box.json";
const std::string program = CASTRAY_PROGRAM;

/// A benchmark of the Cornell box at 32x32 with the reference integrator, in the folder.
std::vector<std::string> small_bench(std::vector<std::string> more) {
  std::vector<std::string> arguments{"bench",
                                     cornell,
                                     "--size",
                                     "32x32",
                                     "--cache",
                                     "cache",
                                     "--spp",
                                     "1,4",
                                     "--seeds",
                                     "3",
                                     "-q",
                                     "--reference-spp",
                                     "32",
                                     "--reference-flags",
                                     "--integrator reference"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

}  // namespace

TEST_CASE("bench measures castray and a peer, and writes table, JSON, CSV, page and plot") {
  const TemporaryFolder folder;
  // The peer is castray itself: its error and its time can be foretold.
  const std::string peer =
      "itself=" + program +
      " render {scene} --integrator reference --spp {spp} --seed {seed} --size {width}x{height} "
      "--threads 1 -q -o {out} && echo seconds: 0.25";
  const RunResult result =
      run_castray(small_bench({"--config", "plain=--integrator reference", "--peer", peer, "--json", "r.json",
                               "--csv", "r.csv", "--html", "r.html", "--svg", "r.svg", "--pictures", "p",
                               "--ablation", "--equal-time", "0.0625"}),
                  folder.path());
  CAPTURE(result.err);
  REQUIRE(result.exit_code == 0);
  CHECK(result.err.empty());
  CHECK_THAT(result.out, Contains("cornell_box, 32x32") && Contains("plain") && Contains("itself"));

  const auto json = nlohmann::json::parse(read_file(folder / "r.json"));
  const auto& scene = json["scenes"][0];
  CHECK(scene["mask"] == "emitters");
  CHECK(scene["counted_share"] > 0.9);
  CHECK(scene["counted_share"] < 1);
  const auto& plain = scene["curves"][0];
  const auto& itself = scene["curves"].back();
  for (int budget = 0; budget < 2; ++budget) {
    for (int run = 0; run < 3; ++run) {
      // The same samples: the peer's image went through a file and is the same.
      CHECK(plain["points"][budget]["runs"][run]["relmse"] ==
            itself["points"][budget]["runs"][run]["relmse"]);
      CHECK(itself["points"][budget]["runs"][run]["seconds"] == 0.25);
    }
    CHECK(plain["points"][budget]["process_seconds"] > 0);
  }
  CHECK(plain["points"][1]["relmse"] < plain["points"][0]["relmse"]);
  CHECK(itself["equal_time"]["spp"] == 1);
  CHECK(itself["detail"] == peer.substr(peer.find('=') + 1));

  for (const char* name : {"reference", "plain", "itself"})
    CHECK(read_image(folder / "p" / fmt::format("cornell_box.{}.png", name)).image.width == 32);
  CHECK(read_image(folder / "p" / "cornell_box.plain.png").image.pixels !=
        read_image(folder / "p" / "cornell_box.reference.png").image.pixels);

  const auto& ablation = scene["ablation"];
  const auto independent = std::find_if(ablation.begin(), ablation.end(),
                                        [](const auto& row) { return row["name"] == "independent samples"; });
  REQUIRE(independent != ablation.end());
  CHECK((*independent)["detail"] == "--integrator reference --sampler independent");
  CHECK((*independent)["relmse_ratio"] != 1);

  CHECK_THAT(read_file(folder / "r.html"), Contains("<!doctype html>") && Contains("data:image/png") &&
                                               Contains("</html>") && !Contains("http"));
  CHECK_THAT(read_file(folder / "r.svg"), Contains("</svg>"));
  CHECK_THAT(read_file(folder / "r.csv"), Contains("cornell_box,itself,peer,4,0.25,"));
}

TEST_CASE("one budget has no slope, and the process time is that of the run of median time") {
  const TemporaryFolder folder;
  const RunResult result =
      run_castray({"bench", cornell, "--size", "16x16", "--cache", "cache", "--spp", "2", "--seeds", "3",
                   "-q", "--reference-spp", "8", "--json", "r.json", "--html", "r.html"},
                  folder.path());
  REQUIRE(result.exit_code == 0);
  const auto curve = nlohmann::json::parse(read_file(folder / "r.json"))["scenes"][0]["curves"][0];
  CHECK(curve["fit"]["slope"].is_null());
  CHECK_THAT(read_file(folder / "r.html"), Contains("<td>castray</td><td>\u2013</td>"));
  const auto& point = curve["points"][0];
  bool found = false;
  for (const auto& run : point["runs"])
    found |= run["seconds"] == point["seconds"] && run["process_seconds"] == point["process_seconds"];
  CHECK(found);
}

TEST_CASE("bench leaves out a peer that has no equal of what a scene holds") {
  const TemporaryFolder folder;
  const RunResult result =
      run_castray(small_bench({"--config", "plain=--integrator reference", "--peer",
                               "other=echo no fog {scene} {spp} {out} >&2; exit 77", "--json", "r.json"}),
                  folder.path());
  CAPTURE(result.err);
  REQUIRE(result.exit_code == 0);
  CHECK_THAT(result.out, Contains("not here: peer other: no fog"));
  const auto curves = nlohmann::json::parse(read_file(folder / "r.json"))["scenes"][0]["curves"];
  CHECK(curves[0]["points"].size() == 2);
  CHECK(curves[1]["points"].empty());
  CHECK_THAT(curves[1]["failure"].get<std::string>(), Contains("no fog"));
}

TEST_CASE("bench keeps the references it made, and takes given ones") {
  const TemporaryFolder folder;
  REQUIRE(
      run_castray(small_bench({"--config", "a=--integrator reference", "--json", "made.json"}), folder.path())
          .exit_code == 0);
  const auto kept = folder / "cache/cornell_box-32x32-A.film";
  const auto written = std::filesystem::last_write_time(kept);
  REQUIRE(
      run_castray(small_bench({"--config", "a=--integrator reference", "--json", "kept.json"}), folder.path())
          .exit_code == 0);
  CHECK(std::filesystem::last_write_time(kept) == written);

  const std::string references = "cache/{scene}-32x32-A.film,cache/{scene}-32x32-B.film";
  REQUIRE(run_castray(small_bench({"--config", "a=--integrator reference", "--reference", references,
                                   "--json", "given.json"}),
                      folder.path())
              .exit_code == 0);
  const auto relmse = [&](const char* file) {
    return nlohmann::json::parse(read_file(folder / file))["scenes"][0]["curves"][0]["points"][1]["relmse"];
  };
  CHECK(relmse("kept.json") == relmse("made.json"));
  CHECK(relmse("given.json") == relmse("made.json"));

  write_file(kept, "no film");  // as a version with another format may have left it
  REQUIRE(run_castray(small_bench({"--config", "a=--integrator reference", "--json", "again.json"}),
                      folder.path())
              .exit_code == 0);
  CHECK(relmse("again.json") == relmse("made.json"));
}

TEST_CASE("bench keeps references for which pilots decided how they are rendered") {
  const TemporaryFolder folder;
  const std::vector<std::string> bench = {"bench",
                                          cornell,
                                          "--size",
                                          "64x64",
                                          "--spp",
                                          "1",
                                          "--seeds",
                                          "1",
                                          "-q",
                                          "--cache",
                                          "cache",
                                          "--reference-spp",
                                          "2",
                                          "--reference-flags",
                                          "--reconstruct off"};
  REQUIRE(run_castray(bench, folder.path()).exit_code == 0);
  const auto kept = folder / "cache/cornell_box-64x64-A.film";
  const auto written = std::filesystem::last_write_time(kept);
  REQUIRE(run_castray(bench, folder.path()).exit_code == 0);
  CHECK(std::filesystem::last_write_time(kept) == written);
}

TEST_CASE("what bench cannot use gets one line and exit code 2") {
  const TemporaryFolder folder;
  const auto refused = [&](std::vector<std::string> more, const std::string& message) {
    const RunResult result = run_castray(small_bench(std::move(more)), folder.path());
    CAPTURE(message);
    CHECK(result.exit_code == 2);
    CHECK(result.out.empty());
    CHECK_THAT(result.err, Catch::StartsWith("castray: error: ") && Contains(message));
    CHECK(std::count(result.err.begin(), result.err.end(), '\n') == 1);
  };
  const std::string config = "a=--integrator reference";
  refused({"--config", "a=--integrator referenze"}, "referenze");
  refused({"--config", "a=--samplr sobol"}, "sampler");
  refused({"--config", "a=--spp 4"}, "--spp");
  refused({"--config", "flags without a name"}, "NAME=FLAGS");
  refused({"--config", config, "--config", "a="}, "--config 'a': another contender has that name");
  refused({"--config", config, "--peer", "a=true {scene} {spp} {out}"}, "--peer 'a': another");
  const std::string endless = "4000000000";  // what can be known is told before the references
  refused({"--config", "a=--isa odd", "--reference-spp", endless}, "--config a: --isa odd: unknown");
  refused({"--config", "a=--isa avx2 --epsilon 1e-5", "--reference-spp", endless}, "--config a: --isa avx2");
  refused({"--config", config, "missing.json", "--reference-spp", endless}, "missing.json: does not exist");
  refused({"--config", config, "--pictures", "/dev/null/p", "--reference-spp", endless},
          "/dev/null/p: cannot be made");
  refused({"--config", config, "--json", "r", "--csv", "./r"}, "more than one output");
  refused({"--config", config, "--equal-time", "-1"}, "--equal-time");
  refused({"--config", config, "--seeds", "0"}, "--seeds");
  refused({"--config", config, "--peer", "x=render {scene} {spp}"}, "{out}");
  refused({"--config", config, "--peer", "x=echo {scene} {spp} {out} >&2; exit 3"}, "exit code 3: ");
  refused({"--config", config, "--peer", "x=true {scene} {spp} {out}"}, "peer x: it wrote no image");
  refused({"--config", config, "--peer",
           "x=" + program + " render {scene} --spp {spp} --size 32x32 --integrator reference -q -o {out}"},
          "'seconds: X'");
  refused({"--config", config, "--peer",
           "x=" + program +
               " render {scene} --spp {spp} --size 16x16 --integrator "
               "reference -q -o {out} && echo seconds: 1"},
          "16x16");
  refused({"--config", config, "--reference", "one.pfm"}, "A,B");
  refused({"--config", config, "--reference", "no_a.pfm,no_b.pfm"}, "no_a.pfm");
  refused({"--config", config, "--json", "missing/r.json"}, "missing");
}
