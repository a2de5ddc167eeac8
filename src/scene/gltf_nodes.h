#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "scene/gltf_document.h"
#include "scene/transform.h"

namespace castray {

/// A mesh, camera or light of a glTF file where a node puts it.
struct GltfPlaced {
  std::size_t node, object;  ///< their numbers in the file
  Transform to_world;
};

struct GltfNodes {
  std::vector<GltfPlaced> meshes, cameras, lights;
};

/// All that the nodes of the file's scene place: of its default scene, else of the first. Copies of
/// EXT_mesh_gpu_instancing are meshes of their own. Throws InputError where the nodes are no tree.
GltfNodes place_nodes(const GltfDocument& document);

/// "camera" of a scene file for a camera. Throws InputError where it defines no view.
nlohmann::ordered_json camera_json(const GltfDocument& document, const GltfPlaced& camera);

/// The names of cameras: their node's, else their own, else "camera"; of equal ones the later are numbered.
std::vector<std::string> camera_names(const GltfDocument& document, const GltfNodes& nodes);

/// Width over height of a camera's image; 0 where the file leaves it open.
double aspect_of(const GltfDocument& document, const GltfPlaced& camera);

/// A member of a scene file's "lights" for a light: candela and lux are its units of intensity and
/// irradiance, as nits are those of radiance.
nlohmann::ordered_json light_json(const GltfDocument& document, const GltfPlaced& light,
                                  WarningList& warnings);

}  // namespace castray
