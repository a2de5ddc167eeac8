// Scene JSON, with OBJ files to name.
#include <unistd.h>

#include <fstream>

#include "fuzz.h"
#include "scene/scene_file.h"
#include "temporary_folder.h"

namespace {

/// Where the scene seems to lie: beside "t.obj", a triangle.
const std::filesystem::path& scene_path() {
  static const TemporaryFolder folder;
  static const std::filesystem::path path = [] {
    std::ofstream(folder / "t.obj") << "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 3//1\n";
    return folder / "s.json";
  }();
  return path;
}

}  // namespace

FUZZ(text) { castray::parse_scene(text, scene_path()); }
