#pragma once

#include "scene/scene_builder.h"

namespace castray {

/// A number of a glTF material, and the image that it multiplies, if there is one.
struct GltfNumber {
  double factor = 0;
  TextureMap map{};

  bool varies() const { return map.used(); }
};

/// Takes an image that says the same everywhere into the factor.
void fold_constant(const SceneBuilder& builder, GltfNumber& number);

/// Whether one image can say what two numbers make of a point: the same points of both images belong to it.
bool lie_alike(const GltfNumber& a, const GltfNumber& b);

/// Sets the lobe of KHR_materials_anisotropy: of width roughness^2 across its direction, and by the square of
/// the strength nearer to 1 along it. Where images say the one or the other, which have to lie alike, makes
/// images of both widths, of 8 bits a value.
void set_lobe(const GltfNumber& roughness, const GltfNumber& strength, SceneBuilder& builder, Material& m);

}  // namespace castray
