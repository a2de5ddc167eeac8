#include <catch2/catch.hpp>

#include <filesystem>
#include <new>
#include <regex>
#include <vector>

#include "cli/film_bands.h"
#include "cli/memory_limit.h"
#include "core/files.h"
#include "run_castray.h"

using Catch::Contains;
using Words = std::vector<std::string>;

namespace {

RunResult render(const TemporaryFolder& folder, const std::vector<std::string>& more) {
  std::vector<std::string> arguments{"render", CASTRAY_ROOT "/scenes/cornell_box.json", "--spp", "1", "-o",
                                     "x.pfm"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return run_castray(arguments, folder.path());
}

}  // namespace

TEST_CASE("a render that needs the whole film is refused before its memory is taken, with what it needs") {
  for (const std::vector<std::string>& whole :
       {std::vector<std::string>{"-o", "x.film"}, {"--checkpoint", "c.film"}, {"--time-limit", "9"}}) {
    const TemporaryFolder folder;
    std::vector<std::string> words{"--size", "16384x16384", "--memory-limit", "2G", "--reconstruct", "off"};
    words.insert(words.end(), whole.begin(), whole.end());
    const RunResult result = render(folder, words);
    CHECK(result.exit_code == 2);
    CHECK_THAT(result.err, Contains("--memory-limit of 2.00 GiB: more is needed") &&
                               (Contains("13.00 GiB for the film (52 a pixel)") ||
                                Contains("26.00 GiB for the film (104 a pixel)")) &&
                               Contains("--crop"));
    CHECK(result.peak_kilobytes < 200 * 1024);
    CHECK(folder.names().empty());
  }
}

namespace {

/// The limit that a refusal names, in MiB.
int named_limit(const RunResult& refusal) {
  std::smatch found;
  REQUIRE(std::regex_search(refusal.err, found, std::regex("give --memory-limit (\\d+)M or more\n$")));
  return std::stoi(found[1]);
}

}  // namespace

TEST_CASE("a refusal names the least limit, with it the render takes no more, and with less it is refused",
          "[memory]") {
  static constexpr int done = 0, target_missed = 1;
  const auto [what, exit_code, flags] = GENERATE(table<std::string, int, Words>({
      {"bands of means", done, {"--size", "256x700", "--reconstruct", "off", "-o", "x.png"}},
      {"bands with margins", done, {"--size", "64x900", "--spp", "4", "--reconstruct", "on", "-o", "x.exr"}},
      {"a few long rows", done, {"--size", "4000x40", "--spp", "4", "--reconstruct", "on", "--threads", "4"}},
      {"a film",
       done,
       {"--size", "300x200", "--spp", "4", "--reconstruct", "on", "-o", "x.film", "-o", "x.hdr"}},
      {"two films", done, {"--size", "300x300", "--spp", "4", "--reconstruct", "off", "--time-limit", "50"}},
      {"pilots",
       target_missed,
       {"--size", "256x256", "--spp", "16", "--reconstruct", "off", "--target-error", "1e-6"}},
      {"reconstructed pilots", target_missed, {"--size", "192x192", "--spp", "12", "--target-error", "1e-6"}},
      {"replicates", done, {"--size", "256x256", "--replicates", "16", "--spp", "16", "-o", "x.exr"}},
  }));
  CAPTURE(what);
  const TemporaryFolder folder;
  const auto with_limit = [&](const std::string& limit) {
    Words words = flags;
    words.insert(words.end(), {"--memory-limit", limit});
    if (std::ranges::find(words, "--threads") == words.end()) words.insert(words.end(), {"--threads", "2"});
    return render(folder, words);
  };
  const RunResult refused = with_limit("1M");
  CHECK(refused.exit_code == 2);
  const int least = named_limit(refused);
  const RunResult less = with_limit(std::to_string(least - 2) + "M");
  CHECK(less.exit_code == 2);
  CHECK(folder.names().empty());
  CHECK(std::abs(named_limit(less) - least) <= 1);
  const RunResult enough = with_limit(std::to_string(least) + "M");
  CAPTURE(enough.err);
  CHECK(enough.exit_code == exit_code);
  CHECK(enough.peak_kilobytes <= 1024L * least);
  CHECK(enough.peak_kilobytes >= 1024L * least / 2);
}

TEST_CASE("bands are whole tiles and no lower than their margins") {
  using castray::cli::band_within;
  const auto a_row = [](int rows) { return static_cast<std::uint64_t>(rows); };
  CHECK(band_within(1000, 0, 100, a_row) == 100);
  CHECK(band_within(100, 0, 100, a_row) == 100);
  CHECK(band_within(99, 0, 100, a_row) == 96);
  CHECK(band_within(8, 0, 100, a_row) == 8);
  CHECK(band_within(7, 0, 100, a_row) == std::nullopt);
  CHECK(band_within(3, 0, 3, a_row) == 3);
  CHECK(band_within(500, 64, 1000, a_row) == 368);
  CHECK(band_within(192, 64, 1000, a_row) == 64);
  CHECK(band_within(191, 64, 1000, a_row) == std::nullopt);
}

TEST_CASE("beyond the limit no memory is handed out", "[memory]") {
  constexpr std::size_t mebibyte = 1 << 20;
  const auto take = [](std::size_t bytes) { return std::vector<char>(bytes).size(); };
  {
    const castray::cli::MemoryLimit limit(castray::cli::bytes_of_program() + 64 * mebibyte, 0);
    CHECK(take(48 * mebibyte) == 48 * mebibyte);
    CHECK_THROWS_AS(take(256 * mebibyte), std::bad_alloc);
  }
  CHECK(take(256 * mebibyte) == 256 * mebibyte);
}

TEST_CASE("an image whose film does not fit is rendered in bands, to the same bytes in every format",
          "[memory]") {
  for (const char* scene : {"cornell_box", "cornell_conductor"}) {
    const TemporaryFolder folder;
    const auto image = [&](const std::string& name, std::vector<std::string> more) {
      std::vector<std::string> words{"render",        std::string(CASTRAY_ROOT "/scenes/") + scene + ".json",
                                     "--size",        "500x301",
                                     "--spp",         "2",
                                     "--threads",     "1",
                                     "--reconstruct", "off"};
      for (const char* suffix : {".ppm", ".png", ".pfm", ".hdr", ".exr"})
        more.insert(more.end(), {"-o", name + suffix});
      words.insert(words.end(), more.begin(), more.end());
      return run_castray(words, folder.path());
    };
    REQUIRE(image("whole", {"-q"}).exit_code == 0);
    const RunResult bands = image("bands", {"--memory-limit", "26M", "--stats", "s.json"});
    CAPTURE(bands.err);
    REQUIRE(bands.exit_code == 0);
    CHECK_THAT(bands.err, Contains("in bands of ") && Contains("500 x 301 pixels, 2 spp") &&
                              Contains("Render complete") && !Contains("black"));
    CHECK_THAT(castray::read_file(folder / "s.json"),
               Contains("\"height\": 301") && Contains("\"paths\": 301000"));
    for (const char* suffix : {".ppm", ".png", ".pfm", ".hdr", ".exr"}) {
      INFO(suffix);
      CHECK(castray::read_file(folder / (std::string("bands") + suffix)) ==
            castray::read_file(folder / (std::string("whole") + suffix)));
    }
  }
}

TEST_CASE("bands of a reconstructed image differ from the whole by much less than its noise", "[memory]") {
  const TemporaryFolder folder;
  const auto image = [&](const char* name, const char* limit) {
    return run_castray({"render", CASTRAY_ROOT "/scenes/cornell_box.json", "--size", "128x1600", "--spp", "4",
                        "--threads", "1", "--reconstruct", "on", "--memory-limit", limit, "-o", name},
                       folder.path());
  };
  REQUIRE(image("whole.pfm", "4G").exit_code == 0);
  const RunResult bands = image("bands.pfm", "48M");
  CAPTURE(bands.err);
  REQUIRE(bands.exit_code == 0);
  CHECK_THAT(bands.err, Contains("in bands of "));
  CHECK(run_castray({"compare", "bands.pfm", "whole.pfm", "--max", "relmse=1e-4"}, folder.path()).exit_code ==
        0);
}

TEST_CASE("an interrupt in a band leaves no file, and says so", "[memory]") {
  const TemporaryFolder folder;
  const RunResult result =
      run_castray({"render", CASTRAY_ROOT "/scenes/cornell_box.json", "--size", "512x512", "--spp", "1000000",
                   "--threads", "1", "--memory-limit", "30M", "--reconstruct", "off", "-o", "x.png"},
                  RunSettings{.folder = folder.path(), .signal = SIGINT});
  CHECK(result.exit_code == 130);
  CHECK_THAT(result.err, Contains("whole or not at all"));
  CHECK(folder.names().empty());
}

TEST_CASE("a band of an image that is too large renders within the limit", "[memory]") {
  const TemporaryFolder folder;
  const RunResult result =
      render(folder, {"--size", "16384x16384", "--crop", "0,8192,16384,8200", "--memory-limit", "1G"});
  CAPTURE(result.err);
  CHECK(result.exit_code == 0);
  CHECK(result.peak_kilobytes < 1024 * 1024);
}

TEST_CASE("the log tells the memory that is needed, sizes have units", "[memory]") {
  const TemporaryFolder folder;
  CHECK_THAT(render(folder, {"--size", "64x64", "-v"}).err,
             Contains("castray: memory: ") && Contains("for the film"));
  CHECK(render(folder, {"--size", "8x8", "--memory-limit", "4294967296"}).exit_code == 0);
  CHECK_THAT(render(folder, {"--memory-limit", "1T"}).err, Contains("--memory-limit '1T'"));
  CHECK(render(folder, {"--memory-limit", "0"}).exit_code == 2);
}
