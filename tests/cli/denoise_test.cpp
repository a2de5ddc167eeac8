// castray denoise, with a library that has Open Image Denoise's interface, and with the real one.
#include <catch2/catch.hpp>

#include "castray/image.h"
#include "castray/metrics.h"
#include "core/files.h"
#include "run_castray.h"

using namespace castray;
using Words = std::vector<std::string>;

namespace {

const std::string box = CASTRAY_ROOT "/scenes/cornell_box.json";

/// A folder where castray finds the library that CASTRAY_OIDN names.
struct Place {
  TemporaryFolder folder;
  std::vector<std::pair<std::string, std::string>> variables{{"CASTRAY_OIDN", CASTRAY_FAKE_OIDN}};

  RunResult run(const Words& words) const {
    return run_castray(words, {.folder = folder.path(), .variables = variables});
  }
  void render(const std::string& file, const Words& more) const {
    Words words = {"render", box, "-q", "--size", "16x12", "--spp", "4", "-o", file};
    words.insert(words.end(), more.begin(), more.end());
    REQUIRE(run(words).exit_code == 0);
  }
  Image image(const std::string& file, const std::string& layer = "") const {
    return read_image(folder / file, layer).image;
  }
};

void check_refused(const RunResult& result, const std::string& words) {
  CHECK(result.exit_code == 2);
  CHECK(result.error_lines() == 1);
  CHECK_THAT(result.err, Catch::Contains(words));
}

}  // namespace

TEST_CASE("an image is denoised with the passes that it has") {
  const Place place;
  const auto sum = [&](const std::string& file, const std::string& albedo, const std::string& normal) {
    Image image = place.image(file);
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
      if (!albedo.empty()) image.pixels[i] += place.image(file, albedo).pixels[i] * 2;
      if (!normal.empty()) image.pixels[i] += place.image(file, normal).pixels[i] * 4;
    }
    return image;
  };
  const auto check = [&](const Words& passes, const std::string& albedo, const std::string& normal,
                         const std::string& said) {
    place.render("a.exr", passes);
    const RunResult result = place.run({"denoise", "a.exr", "-o", "d.exr"});
    CHECK(result.exit_code == 0);
    CHECK(result.err == "biased: Open Image Denoise 9.8.7" + said + "\n");
    CHECK(place.image("d.exr").pixels == sum("a.exr", albedo, normal).pixels);
    const ImageFile denoised = read_image(place.folder / "d.exr");
    CHECK(denoised.metadata.at("castray:denoised") == "Open Image Denoise 9.8.7" + said);
    CHECK(denoised.metadata.contains("castray:biased"));
    CHECK(denoised.metadata.at("castray:seed") == "0");
    CHECK(denoised.left_out.empty());
    CHECK_FALSE(denoised.noise);
  };
  check({}, "", "", "");
  check({"--passes", "albedo"}, "albedo", "", ", guided by albedo");
  check({"--passes", "albedo,normal"}, "albedo", "N", ", guided by albedo and normals");
  check({"--passes", "denoising,albedo,normal", "--replicates", "2"}, "denoising_albedo", "denoising_normal",
        ", guided by albedo and normals");
}

TEST_CASE("what is denoised is neither judged by a z-test nor made a reference") {
  const Place place;
  place.render("a.exr", {"--replicates", "2"});
  REQUIRE(place.run({"denoise", "a.exr", "-o", "d.exr", "-o", "d.png"}).exit_code == 0);
  REQUIRE(place.run({"convert", "d.exr", "-o", "c.exr"}).exit_code == 0);
  check_refused(place.run({"compare", "c.exr", "a.exr", "--ztest", "0.01"}), "no z-test can judge it");
  check_refused(place.run({"compare", "a.exr", "d.exr", "--ztest", "0.01"}), "no z-test can judge by it");
  check_refused(place.run({"accept", "d.exr", "r.exr"}),
                "d.exr: is denoised by Open Image Denoise 9.8.7, so it is biased");
  check_refused(place.run({"accept", "d.png", "r.png"}), "it cannot be a reference");
  check_refused(place.run({"denoise", "d.exr", "-o", "e.exr"}), "denoise the image that it was made of");
  CHECK(place.run({"compare", "d.exr", "a.exr", "--max", "mse=1"}).exit_code == 0);
  CHECK(place.folder.names() == Words{"a.exr", "c.exr", "d.exr", "d.png"});
}

TEST_CASE("without the library, or without radiance or a mark, nothing is denoised") {
  Place place;
  place.render("a.exr", {});
  place.render("a.png", {});
  check_refused(place.run({"denoise", "a.exr", "-o", "d.pfm"}), "cannot say that its image is biased");
  check_refused(place.run({"denoise", "a.png", "-o", "d.exr"}), "is no .exr file");
  place.variables.emplace_back("FAKE_OIDN_ERROR", "no memory");
  check_refused(place.run({"denoise", "a.exr", "-o", "d.exr"}), "Open Image Denoise: no memory");
  place.variables = {{"CASTRAY_OIDN", "/no/such/library.so"}};
  check_refused(place.run({"denoise", "a.exr", "-o", "d.exr"}), "CASTRAY_OIDN: cannot be loaded: ");
  CHECK(place.folder.names() == Words{"a.exr", "a.png"});
}

// Asked for by the CMake option CASTRAY_DENOISE_TESTS; the library is that of the system, or of CASTRAY_OIDN.
TEST_CASE("the real Open Image Denoise lessens the noise", "[.real_denoiser]") {
  Place place;
  place.variables.clear();
  const auto render = [&](const std::string& file, const Words& more) {
    Words words = {"render", box, "-q", "--size", "128x128", "-o", file};
    words.insert(words.end(), more.begin(), more.end());
    REQUIRE(place.run(words).exit_code == 0);
  };
  render("reference.exr", {"--spp", "512", "--seed", "2"});
  render("a.exr", {"--spp", "4", "--reuse", "off", "--passes", "denoising"});
  const RunResult result = place.run({"denoise", "a.exr", "-o", "d.exr"});
  INFO(result.err);
  REQUIRE(result.exit_code == 0);
  const auto error = [&](const std::string& file) {
    return measure_errors(place.image(file), place.image("reference.exr"), 1).relmse;
  };
  CHECK(error("d.exr") < error("a.exr") / 5);
}
