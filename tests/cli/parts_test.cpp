#include <catch2/catch.hpp>

#include <fmt/format.h>

#include "castray/film.h"
#include "core/files.h"
#include "run_castray.h"

using namespace castray;
using Catch::Contains;

namespace {

using Words = std::vector<std::string>;
using Variables = std::vector<std::pair<std::string, std::string>>;

/// A render of the Cornell box in 40x32 pixels.
RunResult render(const TemporaryFolder& folder, const Words& more, const Variables& variables = {}) {
  Words arguments{"render", CASTRAY_ROOT "/scenes/cornell_box.json", "--size", "40x32", "-q"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return run_castray(arguments, {.folder = folder.path(), .variables = variables});
}

RunResult merge(const TemporaryFolder& folder, Words more) {
  more.insert(more.begin(), "merge");
  return run_castray(more, folder.path());
}

}  // namespace

TEST_CASE("the parts of a render merge to its bytes, in any order") {
  const TemporaryFolder folder;
  REQUIRE(render(folder, {"--spp", "10", "-o", "whole.film", "-o", "whole.png"}).exit_code == 0);
  for (const char* part : {"0/3", "1/3", "2/3"})
    REQUIRE(render(folder, {"--spp", "10", "--part", part, "-o", "p{part}.film", "--stats", "p{part}.json"})
                .exit_code == 0);
  CHECK(read_film(folder / "p0.film").samples == std::vector<SampleRange>{{0, 3}});
  CHECK(read_film(folder / "p1.film").samples == std::vector<SampleRange>{{3, 3}});
  CHECK(read_film(folder / "p2.film").samples == std::vector<SampleRange>{{6, 4}});
  CHECK(std::filesystem::exists(folder / "p2.json"));
  for (const Words& order :
       {Words{"p0.film", "p1.film", "p2.film"}, Words{"p2.film", "p0.film", "p1.film"}}) {
    Words words = order;
    words.insert(words.end(), {"-o", "m.film", "-o", "m.png"});
    REQUIRE(merge(folder, words).exit_code == 0);
    CHECK(read_file(folder / "m.film") == read_file(folder / "whole.film"));
    CHECK(read_file(folder / "m.png") == read_file(folder / "whole.png"));
  }
  // in a tree: what is merged in part knows what it is a part of
  REQUIRE(merge(folder, {"p2.film", "p1.film", "--partial", "-o", "m12.film"}).exit_code == 0);
  CHECK(merge(folder, {"m12.film", "-o", "m.film"}).exit_code == 2);
  REQUIRE(merge(folder, {"m12.film", "p0.film", "-o", "m.film"}).exit_code == 0);
  CHECK(read_file(folder / "m.film") == read_file(folder / "whole.film"));
}

TEST_CASE("merge adds any number of films in less memory than one of them takes, to the same bytes",
          "[memory]") {
  const TemporaryFolder folder;
  const auto part = [&](const std::string& name, const Words& more) {
    Words words{"render", CASTRAY_ROOT "/scenes/cornell_conductor.json",
                "--size", "512x1024",
                "-q",     "--threads",
                "1",      "--reconstruct",
                "off",    "-o",
                name};
    words.insert(words.end(), more.begin(), more.end());
    REQUIRE(run_castray(words, folder.path()).exit_code == 0);
  };
  part("a.film", {"--spp", "3", "--part", "0/3", "--crop", "0,0,512,500"});
  part("b.film", {"--spp", "3", "--samples", "1:2", "--crop", "0,0,512,500"});
  part("c.film", {"--spp", "3", "--crop", "0,500,512,1024"});
  const auto merged = [&](const std::string& name, const Words& more) {
    Words words{"c.film", "a.film", "b.film", "-o", name + ".exr", "-o", name + ".png"};
    words.insert(words.end(), more.begin(), more.end());
    return merge(folder, words);
  };
  const RunResult whole = merged("whole", {});
  REQUIRE(whole.exit_code == 0);
  const RunResult bands = merged("bands", {"--memory-limit", "24M"});
  CAPTURE(bands.err);
  REQUIRE(bands.exit_code == 0);
  for (const char* suffix : {".exr", ".png"})
    CHECK(read_file(folder / (std::string("bands") + suffix)) ==
          read_file(folder / (std::string("whole") + suffix)));
  CHECK(whole.peak_kilobytes > 50 * 1024);  // the film alone has 26 MB
  CHECK(bands.peak_kilobytes <= 24 * 1024);
  // a byte that is wrong is found
  std::string bytes = read_file(folder / "b.film");
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
  write_file(folder / "b.film", bytes);
  const RunResult corrupt = merged("corrupt", {"--memory-limit", "24M"});
  CHECK(corrupt.exit_code == 2);
  CHECK_THAT(corrupt.err, Contains("b.film: ") && Contains("checksum"));
  CHECK_FALSE(std::filesystem::exists(folder / "corrupt.exr"));
}

TEST_CASE("merge adds 300 films with the memory of a few", "[memory]") {
  const TemporaryFolder folder;
  REQUIRE(render(folder, {"--size", "256x256", "--samples", "0:1", "--reconstruct", "off", "-o", "p.film"})
              .exit_code == 0);
  const Film first = read_film(folder / "p.film");
  Words names;
  for (std::uint64_t i = 0; i < 300;
       ++i) {  // the same sums under other sample numbers: only bytes are counted here
    Film film = first;
    film.samples = {{i, 1}};
    film.planned = SampleRange{0, 300};
    names.push_back(fmt::format("{}.film", i));
    write_film(folder / names.back(), film);
  }
  Words words = names;
  words.insert(words.end(), {"-o", "m.film"});
  const RunResult all = merge(folder, words);
  CAPTURE(all.err);
  REQUIRE(all.exit_code == 0);
  CHECK(all.peak_kilobytes < 40 * 1024);
  const Film sum = read_film(folder / "m.film");
  CHECK(sum.samples == std::vector<SampleRange>{{0, 300}});
  CHECK(sum.count(100, 100) == 300 * first.count(100, 100));
}

TEST_CASE("merge names what is missing, and does with it only if told to") {
  const TemporaryFolder folder;
  for (const char* part : {"0", "2"})
    REQUIRE(
        render(folder, {"--spp", "8", "--part", fmt::format("{}/4", part), "-o", "p{part}.film"}).exit_code ==
        0);
  const RunResult refused = merge(folder, {"p0.film", "p2.film", "-o", "m.film"});
  CHECK(refused.exit_code == 2);
  CHECK_THAT(refused.err, Contains("missing: samples 2:2, samples 6:2;") && Contains("--partial"));
  CHECK(folder.names() == Words{"p0.film", "p2.film"});
  const RunResult partial = merge(folder, {"p0.film", "p2.film", "--partial", "-o", "m.film"});
  CHECK(partial.exit_code == 0);
  CHECK_THAT(partial.err, Contains("warning: missing: samples 2:2, samples 6:2"));
  CHECK(read_film(folder / "m.film").samples_per_pixel() == 4);
}

TEST_CASE("merge names films that overlap or are of another render") {
  const TemporaryFolder folder;
  const auto film = [&](const char* name, const Words& flags) {
    Words words = flags;
    words.insert(words.end(), {"-o", name});
    REQUIRE(render(folder, words).exit_code == 0);
  };
  film("a.film", {"--spp", "8", "--part", "0/2"});
  film("b.film", {"--spp", "8", "--part", "1/4"});
  film("seed.film", {"--spp", "8", "--part", "1/2", "--seed", "5"});
  film("spp.film", {"--spp", "16", "--part", "1/2"});
  film("crop.film", {"--spp", "8", "--crop", "8,8,16,16"});
  const auto refusal = [&](const char* other) {
    const RunResult result = merge(folder, {"a.film", other, "-o", "m.film"});
    CHECK(result.exit_code == 2);
    CHECK(result.error_lines() == 1);
    return result.err;
  };
  CHECK_THAT(refusal("b.film"), Contains("b.film: cannot be merged with a.film: both films hold sample 2"));
  CHECK_THAT(refusal("seed.film"), Contains("seed.film: cannot be merged with a.film: ") &&
                                       Contains("different renders: seed=5 against seed=0"));
  CHECK_THAT(refusal("spp.film"), Contains("spp.film: ") && Contains("parts of 16 samples and of 8"));
  CHECK_THAT(refusal("crop.film"), Contains("crop.film: ") && Contains("their windows overlap"));
}

TEST_CASE("a part that was stopped early is missing") {
  const TemporaryFolder folder;
  REQUIRE(render(folder, {"--spp", "8", "--part", "0/2", "-o", "p0.film"}).exit_code == 0);
  REQUIRE(render(folder, {"--spp", "8", "--part", "1/2", "-o", "p1.film"}).exit_code == 0);
  Film stopped = read_film(folder / "p1.film").without_samples({40, 32, 0, 0, 40, 32});
  stopped.samples = {{4, 4}};
  stopped.add(1, 1, {1, 1, 1});
  write_film(folder / "p1.film", stopped);
  for (const Words& way : {Words{"-o", "m.film"}, {"-o", "m.pfm", "--memory-limit", "4K"}}) {
    Words words{"p0.film", "p1.film"};
    words.insert(words.end(), way.begin(), way.end());
    const RunResult result = merge(folder, words);
    CHECK(result.exit_code == 2);
    CHECK_THAT(result.err,
               Contains(fmt::format("{} samples of p1.film, which was stopped early", 40 * 32 * 4 - 1)));
  }
}

TEST_CASE("crops of one render merge to its bytes") {
  const TemporaryFolder folder;
  for (const char* integrator : {"wavefront", "reference"}) {
    const auto film = [&](const char* name, Words flags) {
      flags.insert(flags.end(), {"--spp", "3", "--integrator", integrator, "-o", name});
      REQUIRE(render(folder, flags).exit_code == 0);
    };
    film("whole.film", {});
    film("a.film", {"--crop", "0,0,13,32"});
    film("b.film", {"--crop", "13,0,40,11"});
    film("c.film", {"--crop", "13,11,40,32", "--part", "0/2"});
    film("d.film", {"--crop", "13,11,40,32", "--part", "1/2"});
    REQUIRE(merge(folder, {"d.film", "b.film", "c.film", "a.film", "-o", "m.film"}).exit_code == 0);
    CHECK(read_file(folder / "m.film") == read_file(folder / "whole.film"));
    const RunResult hole = merge(folder, {"a.film", "c.film", "d.film", "-o", "m.film"});
    CHECK(hole.exit_code == 2);
    CHECK_THAT(hole.err, Contains("missing: 297 of 1280 pixels"));
    const RunResult thin = merge(folder, {"a.film", "b.film", "c.film", "-o", "m.film"});
    CHECK(thin.exit_code == 2);
    CHECK_THAT(thin.err, Contains("missing: samples 1:2 of window 13,11,40,32"));
  }
}

TEST_CASE("crops with replicates merge to the bytes of the whole") {
  const TemporaryFolder folder;
  const auto film = [&](const char* name, Words flags) {
    flags.insert(flags.end(), {"--spp", "4", "--replicates", "2", "-o", name});
    REQUIRE(render(folder, flags).exit_code == 0);
  };
  film("whole.film", {});
  film("a.film", {"--crop", "0,0,13,32"});
  film("b.film", {"--crop", "13,0,40,32"});
  REQUIRE(merge(folder, {"b.film", "a.film", "-o", "m.film"}).exit_code == 0);
  CHECK(read_file(folder / "m.film") == read_file(folder / "whole.film"));
}

TEST_CASE("the part of --part auto is what the engine says") {
  const TemporaryFolder folder;
  struct Case {
    Variables variables;
    const char* part;
    SampleRange samples;
  };
  const Case cases[] = {
      {{{"SLURM_ARRAY_TASK_ID", "2"}, {"SLURM_ARRAY_TASK_COUNT", "4"}, {"SLURM_ARRAY_TASK_MIN", "0"}},
       "auto",
       {4, 2}},
      {{{"SLURM_ARRAY_TASK_ID", "15"},
        {"SLURM_ARRAY_TASK_COUNT", "2"},
        {"SLURM_ARRAY_TASK_MIN", "10"},
        {"SLURM_ARRAY_TASK_STEP", "5"}},
       "auto",
       {4, 4}},
      {{{"SLURM_ARRAY_TASK_ID", "3"}, {"SLURM_ARRAY_TASK_COUNT", "1"}, {"SLURM_ARRAY_TASK_MIN", "3"}},
       "auto/8",
       {3, 1}},
      {{{"JOB_COMPLETION_INDEX", "1"}}, "auto/2", {4, 4}},
      {{{"AWS_BATCH_JOB_ARRAY_INDEX", "0"}}, "auto/2", {0, 4}},
      {{{"OMPI_COMM_WORLD_RANK", "1"}, {"OMPI_COMM_WORLD_SIZE", "2"}}, "auto", {4, 4}},
      {{{"PMI_RANK", "0"}, {"PMI_SIZE", "2"}}, "auto", {0, 4}},
      {{{"SLURM_PROCID", "1"}, {"SLURM_NTASKS", "4"}}, "auto", {2, 2}},
  };
  for (const Case& c : cases) {
    CAPTURE(c.variables.front().first, c.part);
    REQUIRE(render(folder, {"--spp", "8", "--part", c.part, "-o", "p.film"}, c.variables).exit_code == 0);
    CHECK(read_film(folder / "p.film").samples == std::vector{c.samples});
  }
  const auto refusal = [&](const char* part, const Variables& variables) {
    const RunResult result = render(folder, {"--spp", "8", "--part", part, "-o", "p.film"}, variables);
    CHECK(result.exit_code == 2);
    return result.err;
  };
  CHECK_THAT(refusal("auto", {}), Contains("--part auto: no Slurm array"));
  CHECK_THAT(refusal("auto", {{"JOB_COMPLETION_INDEX", "1"}}), Contains("give auto/N"));
  CHECK_THAT(refusal("auto/2", {{"JOB_COMPLETION_INDEX", "2"}}),
             Contains("parts are counted from 0: 0/2 to 1/2"));
  CHECK_THAT(refusal("auto/2", {{"JOB_COMPLETION_INDEX", "x"}}), Contains("JOB_COMPLETION_INDEX"));
  CHECK_THAT(refusal("4/4", {}), Contains("parts are counted from 0: 0/4 to 3/4"));
  CHECK_THAT(refusal("0/9", {}), Contains("there are 8 samples; 8 parts at most"));
  CHECK_THAT(refusal("half", {}), Contains("must be I/N, as in 0/4, auto, or auto/N"));
}

TEST_CASE("numbers of parts in names have leading zeros") {
  const TemporaryFolder folder;
  REQUIRE(render(folder, {"--spp", "16", "--part", "7/16", "-o", "{part}.film"}).exit_code == 0);
  REQUIRE(render(folder, {"--spp", "16", "--part", "7/10", "-o", "{part}.film"}).exit_code == 0);
  CHECK(folder.names() == Words{"07.film", "7.film"});
}
