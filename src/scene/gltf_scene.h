#pragma once

#include <optional>

#include "scene/gltf_nodes.h"
#include "scene/obj_mesh.h"

namespace castray {

/// Adds the meshes of the file's scene, moved by `transform`, with their materials or those that `options`
/// names; with `object`, to that. A mesh that is in several places is an object of its own, unless it is
/// part of one. Throws InputError.
void add_gltf(const GltfDocument& document, const MeshOptions& options, const Transform& transform,
              SceneBuilder& builder, std::optional<std::size_t> object = {});

/// The scene of the file alone: its meshes, lights and cameras, which are in `nodes`.
Scene scene_of_gltf(const GltfDocument& document, const GltfNodes& nodes, WarningList warnings);

/// The size of an image of width over height `aspect`, whose longer side is `longest` pixels.
std::array<int, 2> size_of_aspect(double aspect, int longest);

}  // namespace castray
