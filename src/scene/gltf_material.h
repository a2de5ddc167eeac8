#pragma once

#include <string>
#include <vector>

#include "scene/gltf_texture.h"

namespace castray {

/// The texture coordinates for material `index` of the file; the first set for -1, the default material.
GltfUvs uvs_of(const GltfDocument& document, int index);

/// Material `index` of the file as castray has it, by the table of docs/scenes.md; -1 is the default material
/// of glTF. It has no name yet. Images go to the builder. Warns of what has no counterpart; throws
/// InputError.
Material make_material(const GltfDocument& document, int index, bool vertex_colors, SceneBuilder& builder);

/// The name of each material, without two that are the same; the last is that of the default material.
std::vector<std::string> material_names(const GltfDocument& document);

}  // namespace castray
