#pragma once

#include "scene/scene_builder.h"
#include "scene/texture_statement.h"

namespace castray {

/// The map of a texture statement, its image added to the scene; without an image where that is not to be
/// found or in no format that is read, with a warning. Throws InputError at the statement where the image is
/// broken. Colours are as sRGB stores them, numbers as they are, unless -colorspace says otherwise.
TextureMap read_map(const TextureStatement& statement, ColorSpace usual, TextureMeaning meaning,
                    SceneBuilder& builder);

/// As read_map of an image that multiplies the exponent `ns` of a highlight: the map of its roughness, by the
/// width that Ns stands for (alpha_of_exponent).
TextureMap read_exponent_map(const TextureStatement& statement, double ns, SceneBuilder& builder);

/// GGX's width for the exponent of a highlight, MTL's Ns: sqrt(2 / (ns + 2)), of the Beckmann distribution
/// whose Blinn-Phong lobe is like it (Walter et al. 2007, section 5.2).
double alpha_of_exponent(double ns);

/// Whether an image's colours, rather than grey heights, say that it is of normals.
bool holds_normals(const Texture& texture);

/// Whether an image has an alpha channel that is not 1 everywhere.
bool has_holes(const Texture& texture);

}  // namespace castray
