// glTF, into a finished scene.
#include "fuzz.h"
#include "scene/gltf_scene.h"

FUZZ(bytes) {
  castray::WarningList warnings;
  const castray::GltfDocument document = castray::parse_gltf(bytes, "nowhere/o.glb", warnings);
  castray::scene_of_gltf(document, place_nodes(document), std::move(warnings));
}
