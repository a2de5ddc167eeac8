#pragma once

#include <catch2/catch.hpp>

#include "gltf_file.h"
#include "scene/gltf_scene.h"

namespace castray {

inline Scene read_gltf_scene(const std::string& bytes, const std::string& file = "t.glb") {
  WarningList warnings;
  const GltfDocument document = parse_gltf(bytes, file, warnings);
  return scene_of_gltf(document, place_nodes(document), std::move(warnings));
}

/// The scene of a file that nothing is to be said about.
inline Scene read_gltf_well(const GltfFile& file) {
  Scene scene = read_gltf_scene(file.glb());
  for (const SceneWarning& warning : scene.warnings) UNSCOPED_INFO(warning.text());
  CHECK(scene.warnings.empty());
  return scene;
}

}  // namespace castray
