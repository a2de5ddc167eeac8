#include <catch2/catch.hpp>

#include <filesystem>

#include "core/files.h"
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

TEST_CASE("a render that needs the whole film is refused before its memory is taken, with what it needs") {
  for (const std::vector<std::string>& whole :
       {std::vector<std::string>{"-o", "x.film"}, {"--checkpoint", "c.film"}, {"--time-limit", "9"}}) {
    const TemporaryFolder folder;
    std::vector<std::string> words{"--size", "16384x16384", "--memory-limit", "2G", "--reconstruct", "off"};
    words.insert(words.end(), whole.begin(), whole.end());
    const RunResult result = render(folder, words);
    CHECK(result.exit_code == 2);
    CHECK_THAT(result.err, Contains("--memory-limit of 2.00 GiB: more is needed") &&
                               Contains("13.00 GiB for the film (52 a pixel)") && Contains("--crop"));
    CHECK(result.peak_kilobytes < 200 * 1024);
    CHECK(folder.names().empty());
  }
  const TemporaryFolder folder;
  CHECK_THAT(render(folder, {"--memory-limit", "1M"}).err, Contains("give a higher --memory-limit"));
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
    const RunResult bands = image("bands", {"--memory-limit", "18M", "--stats", "s.json"});
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
                   "--threads", "1", "--memory-limit", "22M", "--reconstruct", "off", "-o", "x.png"},
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

TEST_CASE("what goes beyond the limit while it renders is one line, not a killed process") {
  const TemporaryFolder folder;
  const RunResult result = render(folder, {"--size", "1024x1024", "--memory-limit", "68M", "--threads", "4",
                                           "--reconstruct", "off", "-o", "x.film", "-q"});
  CHECK(result.exit_code == 2);
  CHECK(result.error_lines() == 1);
  CHECK_THAT(result.err, Contains("memory"));
}

TEST_CASE("the log tells the memory that is needed, sizes have units", "[memory]") {
  const TemporaryFolder folder;
  CHECK_THAT(render(folder, {"--size", "64x64", "-v"}).err,
             Contains("castray: memory: ") && Contains("for the film"));
  CHECK(render(folder, {"--size", "8x8", "--memory-limit", "4294967296"}).exit_code == 0);
  CHECK_THAT(render(folder, {"--memory-limit", "1T"}).err, Contains("--memory-limit '1T'"));
  CHECK(render(folder, {"--memory-limit", "0"}).exit_code == 2);
}
