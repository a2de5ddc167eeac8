#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "castray/scene.h"

namespace castray {

/// A scene file with the images beside it, as yet unwritten.
struct SceneFiles {
  struct File {
    std::filesystem::path path;
    std::string bytes;
  };
  std::vector<File> images;  ///< what the input holds within itself, or castray makes of it
  File scene;                ///< JSON
  std::vector<SceneWarning> warnings;
};

/// The scene file `output` that shows what the .gltf, .glb, .obj or .ply file `input` does: its camera,
/// lights, environment and all materials by name, and the meshes where they are, in `input`. Paths are
/// relative to the folder of `output`. Throws InputError.
SceneFiles convert_scene(const std::filesystem::path& input, const std::filesystem::path& output);

}  // namespace castray
