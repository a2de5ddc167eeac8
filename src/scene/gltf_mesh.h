#pragma once

#include "scene/gltf_texture.h"
#include "scene/mesh.h"

namespace castray {

/// The triangles of a primitive, of material 0. None, with a warning, where it has points or lines. Throws
/// InputError where its accessors do not fit together. `mesh` is its mesh's number.
Mesh read_primitive(const GltfDocument& document, const tinygltf::Primitive& primitive, const GltfUvs& uvs,
                    std::size_t mesh, WarningList& warnings);

}  // namespace castray
