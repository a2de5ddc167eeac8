// Scenes with several cameras: --camera chooses one.
#include <catch2/catch.hpp>

#include <fstream>

#include "core/files.h"
#include "gltf_file.h"
#include "run_castray.h"

namespace {

/// A square seen by "front" from afar, by "side", whose node has no name, from nearby and from one side, and
/// by another "side".
GltfFile watched_square() {
  GltfFile file;
  file.add_node({{"mesh", file.add_square()}});
  const auto camera = [&](const char* name, double aspect) {
    return file.add("cameras", {{"type", "perspective"},
                                {"name", name},
                                {"perspective", {{"yfov", 0.7}, {"znear", 0.1}, {"aspectRatio", aspect}}}});
  };
  file.add_node({{"camera", camera("lens", 1)}, {"name", "front"}, {"translation", {0.5, 0.5, 5}}});
  file.add_node({{"camera", camera("side", 2)}, {"translation", {0.9, 0.2, 2}}});
  file.add_node({{"camera", camera("side", 0.5)}, {"translation", {0.1, 0.3, 1}}});
  return file;
}

std::string image_of(const TemporaryFolder& folder, std::vector<std::string> words) {
  words.insert(words.begin(), "render");
  for (const char* word : {"-q", "--spp", "1", "-o", "image.pfm"}) words.emplace_back(word);
  const RunResult result = run_castray(words, folder.path());
  INFO(result.err);
  CHECK(result.exit_code == 0);
  return file_content(folder / "image.pfm");
}

}  // namespace

TEST_CASE("the flag --camera chooses among a glTF file's cameras, and among those of a scene file") {
  const TemporaryFolder folder;
  castray::write_file(folder / "a.glb", watched_square().glb());
  const std::string first = image_of(folder, {"a.glb"});
  CHECK(image_of(folder, {"a.glb", "--camera", "front"}) == first);
  CHECK(image_of(folder, {"a.glb", "--camera", "0"}) == first);
  const std::string side = image_of(folder, {"a.glb", "--camera", "side"});
  CHECK(side.starts_with("PF\n784 392\n"));
  CHECK(image_of(folder, {"a.glb", "--camera", "1"}) == side);
  CHECK(image_of(folder, {"a.glb", "--camera", "side 2"}).starts_with("PF\n392 784\n"));

  CHECK(run_castray({"convert", "a.glb", "-o", "a.json"}, folder.path()).exit_code == 0);
  CHECK(image_of(folder, {"a.json", "--camera", "1", "--size", "784x392"}) == side);
  CHECK(image_of(folder, {"a.json"}) == first);
  CHECK_THAT(run_castray({"info", "a.glb"}, folder.path()).out,
             Catch::Contains("camera 0   front\ncamera 1   side\ncamera 2   side 2\n"));
}

TEST_CASE("a camera that is not there is an error that names those that are") {
  const TemporaryFolder folder;
  castray::write_file(folder / "a.glb", watched_square().glb());
  std::ofstream(folder / "a.obj") << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  const auto error_of = [&](const std::string& scene, const std::string& camera) {
    const RunResult result = run_castray({"render", scene, "--camera", camera}, folder.path());
    CHECK(result.exit_code == 2);
    return result.err;
  };
  CHECK(error_of("a.glb", "top") ==
        "castray: error: --camera top: a.glb has no such camera; it has front, side, side 2\n");
  CHECK(error_of("a.glb", "3") ==
        "castray: error: --camera 3: a.glb has no such camera; it has front, side, side 2\n");
  CHECK(error_of("a.glb", "99999999999999999999") ==
        "castray: error: --camera 99999999999999999999: a.glb "
        "has no such camera; it has front, side, side 2\n");
  CHECK(error_of("a.obj", "0") == "castray: error: --camera 0: a.obj has no such camera; it has none\n");
}
