#pragma once

#include "scene/scene_builder.h"
#include "scene/texture_statement.h"

namespace castray {

/// The map of a texture statement, its image added to the scene; without an image where that is not to be
/// found or in no format that is read, with a warning. Throws InputError at the statement where the image is
/// broken. Colours are as sRGB stores them, numbers as they are, unless -colorspace says otherwise.
TextureMap read_map(const TextureStatement& statement, ColorSpace usual, SceneBuilder& builder);

/// Whether an image's colours, rather than grey heights, say that it is of normals.
bool holds_normals(const Texture& texture);

/// Whether an image has an alpha channel that is not 1 everywhere.
bool has_holes(const Texture& texture);

}  // namespace castray
