#pragma once

#include <optional>

#include "scene/gltf_document.h"
#include "scene/scene_builder.h"

namespace castray {

/// An affine map of texture coordinates: (u,v) -> (u0 u + u1 v + u2, v0 u + v1 v + v2).
struct UvTransform {
  double u[3] = {1, 0, 0}, v[3] = {0, 1, 0};

  bool turns() const { return u[1] != 0 || v[0] != 0; }
};

/// What a material says of an image: which, and where on the surface.
struct GltfTextureUse {
  int texture = -1;  ///< -1: none
  int uv_set = 0;    ///< of TEXCOORD_n
  UvTransform transform;

  bool used() const { return texture >= 0; }
};

GltfTextureUse texture_use(const tinygltf::TextureInfo& info);
GltfTextureUse texture_use(const tinygltf::NormalTextureInfo& info);
/// The member `key` of an extension, which may be null.
GltfTextureUse texture_use(const tinygltf::Value* extension, const char* key);

/// The texture coordinates that the triangles of one material get: castray has one set for a triangle, and
/// its maps scale and move them but do not turn them. So what turns is done to the mesh.
struct GltfUvs {
  int set = 0;
  UvTransform turn;  ///< the identity, unless an image is turned
};

/// The map of an image, added to the builder's textures, over those texture coordinates. None, with a
/// warning, where the image cannot be read. `material` is named where something is left out.
std::optional<TextureMap> make_map(const GltfDocument& document, const GltfTextureUse& use,
                                   const GltfUvs& uvs, ColorSpace space, std::size_t material,
                                   SceneBuilder& builder, TextureMeaning meaning = TextureMeaning::amounts);

/// The encoded bytes of an image that lies within the file or one of its buffers. Throws InputError where it
/// has a file of its own.
std::string_view embedded_image(const GltfDocument& document, std::size_t image);

}  // namespace castray
