// EXR files with passes, as the command line makes them.
#include <ImfChannelList.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <catch2/catch.hpp>

#include "castray/image.h"
#include "core/files.h"
#include "run_castray.h"

using namespace castray;
using Words = std::vector<std::string>;

namespace {

Words render(const Words& more) {
  Words words = {"render", CASTRAY_ROOT "/scenes/cornell_box.json", "-q", "--size", "32x24"};
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

Image layer(const std::filesystem::path& file, const std::string& name = "") {
  return read_image(file, name).image;
}

}  // namespace

TEST_CASE("passes are channels beside an image that they do not change") {
  const TemporaryFolder folder;
  const auto run = [&](const Words& words) { return run_castray(words, folder.path()).exit_code; };
  REQUIRE(run(render({"--spp", "8", "-o", "plain.exr", "-o", "plain.png"})) == 0);
  REQUIRE(run(render({"--spp", "8", "-o", "all.exr", "-o", "all.png", "--passes", "all"})) == 0);
  CHECK(read_image(folder / "plain.exr").left_out.empty());
  CHECK(layer(folder / "all.exr").pixels == layer(folder / "plain.exr").pixels);
  CHECK(layer(folder / "all.png").pixels == layer(folder / "plain.png").pixels);
  const Image all = layer(folder / "all.exr"), direct = layer(folder / "all.exr", "direct"),
              indirect = layer(folder / "all.exr", "indirect");
  double sum = 0;
  for (std::size_t i = 0; i < all.pixels.size(); ++i) {
    for (int c = 0; c < 3; ++c)
      CHECK(direct.pixels[i][c] + indirect.pixels[i][c] == Approx(all.pixels[i][c]).margin(1e-5));
    sum += static_cast<double>(indirect.pixels[i].y);
  }
  CHECK(sum / static_cast<double>(all.pixels.size()) > 0.05);
  CHECK(layer(folder / "all.exr", "samples").at(5, 5) == Vec3f(8));
  const Metadata metadata = read_image(folder / "all.exr").metadata;
  CHECK(metadata.at("cryptomatte/3ae39a5/name") == "CryptoObject");
  CHECK_THAT(metadata.at("cryptomatte/3ae39a5/manifest"), Catch::Contains("\"tallbox\":\"d46eed16\""));
  CHECK(metadata.at("cryptomatte/be359d6/name") == "CryptoMaterial");
}

TEST_CASE("direct light is that of paths of two edges") {
  const TemporaryFolder folder;
  const auto run = [&](const Words& words) { return run_castray(words, folder.path()).exit_code; };
  REQUIRE(run(render({"--spp", "8", "-o", "a.exr", "--passes", "direct"})) == 0);
  REQUIRE(run(render({"--spp", "8", "-o", "b.exr", "--max-depth", "2", "--passes", "direct,indirect"})) == 0);
  CHECK(layer(folder / "a.exr", "direct").pixels == layer(folder / "b.exr").pixels);
  CHECK(layer(folder / "b.exr", "direct").pixels == layer(folder / "b.exr").pixels);
  for (const Vec3f& v : layer(folder / "b.exr", "indirect").pixels) CHECK(v == Vec3f());
}

TEST_CASE("with 16 bits a value colours and normals are halves, places and ids are not") {
  const TemporaryFolder folder;
  REQUIRE(run_castray(render({"--spp", "4", "--bits", "16", "--passes", "all", "-o", "a.exr"}), folder.path())
              .exit_code == 0);
  const Imf::InputFile file((folder / "a.exr").c_str());
  const auto type = [&](const char* channel) { return file.header().channels().findChannel(channel)->type; };
  for (const char* half : {"R", "albedo.R", "N.X", "direct.G", "indirect.B", "denoising_normal.Z"})
    CHECK(type(half) == Imf::HALF);
  for (const char* full : {"Z", "P.X", "CryptoObject00.R", "CryptoMaterial02.A", "samples.Y"})
    CHECK(type(full) == Imf::FLOAT);
  CHECK(layer(folder / "a.exr", "albedo").at(16, 12).x == Approx(0.725).epsilon(1e-3));
}

TEST_CASE("a film merged of parts gets the passes of the whole render") {
  const TemporaryFolder folder;
  const auto run = [&](const Words& words) { return run_castray(words, folder.path()).exit_code; };
  const Words passes = {"--spp", "6", "--passes", "albedo,depth,object,indirect,samples"};
  const auto with = [&](const Words& more) {
    Words words = render(passes);
    words.insert(words.end(), more.begin(), more.end());
    return words;
  };
  REQUIRE(run(with({"-o", "whole.exr"})) == 0);
  REQUIRE(run(render({"--spp", "6", "--part", "0/2", "-o", "0.film"})) == 0);
  REQUIRE(run(render({"--spp", "6", "--part", "1/2", "-o", "1.film"})) == 0);
  REQUIRE(run({"merge", "1.film", "0.film", "-o", "m.film"}) == 0);
  REQUIRE(run(with({"--checkpoint", "m.film", "--resume", "-o", "merged.exr"})) == 0);
  for (const char* name : {"", "albedo", "Z", "CryptoObject00", "indirect", "samples"})
    CHECK(layer(folder / "merged.exr", name).pixels == layer(folder / "whole.exr", name).pixels);
}

TEST_CASE("passes are refused where there is no place or no measure for them") {
  const TemporaryFolder folder;
  const auto refused = [&](const Words& more, const std::string& words) {
    const RunResult result = run_castray(render(more), folder.path());
    CHECK(result.exit_code == 2);
    CHECK(result.error_lines() == 1);
    CHECK_THAT(result.err, Catch::Contains(words));
    CHECK(folder.names().empty());
  };
  refused({"--passes", "albedo", "-o", "a.png"}, "--passes: only .exr files hold passes; add -o FILE.exr");
  refused({"--passes", "albedo,normals", "-o", "a.exr"}, "did you mean 'normal'?");
  refused({"--passes", "variance", "-o", "a.exr"}, "add --replicates 16");
  refused({"--passes", "direct", "--time-limit", "1", "-o", "a.exr"}, "leave them out");
  refused({"--passes", "all", "--target-error", "1", "-o", "a.exr"}, "leave them out");
}

TEST_CASE("the variance that replicates tell is a pass like others") {
  const TemporaryFolder folder;
  REQUIRE(
      run_castray(render({"--spp", "8", "--replicates", "4", "--passes", "variance,samples", "-o", "a.exr"}),
                  folder.path())
          .exit_code == 0);
  CHECK(read_image(folder / "a.exr").noise);
  CHECK(layer(folder / "a.exr", "samples").at(0, 0) == Vec3f(8));
}
