#include <catch2/catch.hpp>

#include <nlohmann/json.hpp>

#include "core/files.h"
#include "run_castray.h"

using namespace castray;
using Catch::Contains;

namespace {

using Words = std::vector<std::string>;

const std::string cornell = CASTRAY_ROOT "/scenes/cornell_box.json";

RunResult submit(const TemporaryFolder& folder, const std::string& engine, const Words& more) {
  Words arguments{"submit", engine, cornell, "--size", "40x32", "--spp", "10"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return run_castray(arguments, folder.path());
}

int shell(const std::string& command) { return std::system(command.c_str()); }

}  // namespace

TEST_CASE("submit local --run renders the parts and merges them to the bytes of the whole") {
  const TemporaryFolder folder;
  REQUIRE(run_castray({"render", cornell, "--size", "40x32", "--spp", "10", "--exposure", "1", "-q", "-o",
                       "w.film", "-o", "w.ppm"},
                      folder.path())
              .exit_code == 0);
  const RunResult run = submit(folder, "local",
                               {"--exposure", "1", "--parts", "3", "--jobs", "2", "-o", "it's m.film", "-o",
                                "m.ppm", "--run", "--folder", "the parts"});
  CAPTURE(run.err);
  CHECK(run.exit_code == 0);
  CHECK(read_file(folder / "it's m.film") == read_file(folder / "w.film"));
  CHECK(read_file(folder / "m.ppm") == read_file(folder / "w.ppm"));
}

TEST_CASE("a part that fails is tried again from its checkpoint, then fails the whole") {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder / "p/checkpoints");
  write_file(folder / "p/checkpoints/1.film", "no film");
  const RunResult run = submit(folder, "local", {"--parts", "2", "-o", "m.film", "--run", "--folder", "p"});
  CHECK(run.exit_code != 0);
  std::size_t tries = 0;
  for (std::size_t at = 0; (at = run.err.find("1.film: is not a film", at)) != std::string::npos; ++at)
    ++tries;
  CHECK(tries == 4);
  CHECK_FALSE(std::filesystem::exists(folder / "m.film"));
}

TEST_CASE(
    "submit slurm prints an array that is requeued and a merge that depends on it, with no side effect") {
  const TemporaryFolder folder;
  const RunResult run = submit(folder, "slurm",
                               {"--parts", "4", "-o", "m.png", "--tone", "gamma:0.6", "--options",
                                "--partition=long", "--reuse", "off"});
  CHECK(run.exit_code == 0);
  CHECK(folder.names().empty());
  CHECK_THAT(run.out, Contains("--array=0-3 --requeue") && Contains("--partition=long") &&
                          Contains("--dependency=afterok:$array") && Contains("--part auto/4") &&
                          Contains("--checkpoint 'cornell_box.parts/checkpoints/{part}.film' --resume") &&
                          Contains("scontrol requeue") &&
                          Contains("merge --tone gamma:0.6 cornell_box.parts/*.film"));
  write_file(folder / "script", run.out);
  CHECK(shell("sh -n " + std::string(folder / "script")) == 0);

  // With an sbatch that only notes what it is given, the script passes the array's number on.
  std::filesystem::create_directories(folder / "bin");
  write_file(folder / "bin/sbatch", "#!/bin/sh\necho \"$@\" >>" + std::string(folder / "calls") + "\ncat >>" +
                                        std::string(folder / "calls") + "\necho 42\n");
  std::filesystem::permissions(folder / "bin/sbatch", std::filesystem::perms::owner_all);
  CHECK(shell("cd " + folder.path().string() + " && PATH=$PWD/bin:$PATH sh script >out") == 0);
  const std::string calls = read_file(folder / "calls");
  CHECK_THAT(calls, Contains("--dependency=afterok:42") && Contains("${SLURM_RESTART_COUNT:-0}"));
}

TEST_CASE("submit kubernetes prints an indexed job and the merge as a list") {
  const TemporaryFolder folder;
  const RunResult run =
      submit(folder, "kubernetes",
             {"--parts", "4", "-o", "m.png", "--image", "registry/castray:1", "--claim", "films"});
  REQUIRE(run.exit_code == 0);
  const auto list = nlohmann::json::parse(run.out);
  CHECK(list["kind"] == "List");
  const auto& render = list["items"][0];
  CHECK(render["metadata"]["name"] == "castray-cornell-box");
  CHECK(render["spec"]["completions"] == 4);
  CHECK(render["spec"]["completionMode"] == "Indexed");
  const auto& pod = render["spec"]["template"]["spec"];
  CHECK(pod["containers"][0]["image"] == "registry/castray:1");
  CHECK(pod["volumes"][0]["persistentVolumeClaim"]["claimName"] == "films");
  CHECK_THAT(pod["containers"][0]["command"][2].get<std::string>(),
             Contains("castray render") && Contains("--part auto/4") && Contains("--resume"));
  CHECK_THAT(list["items"][1]["spec"]["template"]["spec"]["containers"][0]["command"][2].get<std::string>(),
             Contains("-eq 4 ]") && Contains("castray merge cornell_box.parts/*.film -o m.png"));
  CHECK_THAT(submit(folder, "kubernetes", {"--parts", "4"}).err,
             Contains("submit kubernetes: needs --image"));
}

TEST_CASE("submit batch prints an array job and the merge that depends on it") {
  const TemporaryFolder folder;
  const RunResult run =
      submit(folder, "batch", {"--parts", "4", "-o", "m.png", "--queue", "q", "--definition", "d"});
  REQUIRE(run.exit_code == 0);
  CHECK_THAT(run.out, Contains("--array-properties size=4") && Contains("--retry-strategy attempts=4") &&
                          Contains("--depends-on jobId=\"$array\"") && Contains("--part auto/4"));
  write_file(folder / "script", run.out);
  CHECK(shell("sh -n " + std::string(folder / "script")) == 0);
  CHECK_THAT(submit(folder, "batch", {"--queue", "q"}).err, Contains("submit batch: needs --definition"));
}

TEST_CASE("submit refuses what the parts could not be rendered with") {
  const TemporaryFolder folder;
  CHECK_THAT(submit(folder, "slurm", {"--parts", "11"}).err, Contains("10 samples; 10 parts at most"));
  CHECK_THAT(submit(folder, "slurm", {"--part", "0/2"}).err, Contains("--part: cannot go with submit"));
  CHECK_THAT(submit(folder, "slurm", {"--spp", "0"}).err, Contains("--spp '0'"));
  CHECK_THAT(submit(folder, "slurm", {"-o", "gone/x.png"}).err, Contains("the folder gone does not exist"));
  CHECK(submit(folder, "condor", {}).exit_code == 2);
}
