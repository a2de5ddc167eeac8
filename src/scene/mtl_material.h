#pragma once

#include "scene/mtl_file.h"
#include "scene/scene_builder.h"

namespace castray {

/// Adds to the scene what an MTL file means by one of its materials, by the table in docs/scenes.md, with its
/// textures; returns its position. Where the material says no Kd, `vertex_colors` of the mesh stand for it.
/// Warns of what is not there and of what is not done.
std::uint16_t add_material(const MtlFile& file, const MtlMaterial& mtl, bool vertex_colors,
                           SceneBuilder& builder);

}  // namespace castray
