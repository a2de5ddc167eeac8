#include "scene/gltf_texture.h"

#include <fmt/core.h>

#include <cmath>

#include "castray/image.h"
#include "core/text.h"
#include "materials/texture.h"
#include "scene/gltf_accessor.h"
#include "scene/gltf_value.h"

namespace castray {

namespace {

constexpr const char* transform_extension = "KHR_texture_transform";

/// Scaled, then turned counter-clockwise as seen on the image, then moved; v grows downwards.
UvTransform read_transform(const tinygltf::Value* extension) {
  const tinygltf::Value *offset = find_value(extension, "offset"), *scale = find_value(extension, "scale");
  const double turn = number_in(extension, "rotation", 0), c = std::cos(turn), s = std::sin(turn);
  const double su = number_at(scale, 0, 1), sv = number_at(scale, 1, 1);
  return {{c * su, s * sv, number_at(offset, 0, 0)}, {-s * su, c * sv, number_at(offset, 1, 0)}};
}

GltfTextureUse make_use(int texture, int uv_set, const tinygltf::Value* transform) {
  if (!transform) return {texture, uv_set, {}};
  return {texture, integer_in(transform, "texCoord", uv_set), read_transform(transform)};
}

bool same_turn(const UvTransform& a, const UvTransform& b) {
  return std::equal(a.u, a.u + 3, b.u) && std::equal(a.v, a.v + 3, b.v);
}

/// Of the texture coordinates that the mesh has, with v upwards.
void place_on_mesh(const UvTransform& t, TextureMap& map) {
  map.scale = {static_cast<float>(t.u[0]), static_cast<float>(t.v[1])};
  map.offset = {static_cast<float>(t.u[2]), static_cast<float>(1 - t.v[1] - t.v[2])};
}

/// The image's file, or its number within the file's path.
std::string name_of(const GltfDocument& document, std::size_t image) {
  const tinygltf::Image& i = document.model.images[image];
  return i.name.empty() ? fmt::format("image {}", image) : i.name;
}

int add_image(const GltfDocument& document, std::size_t image, ColorSpace space, TextureMeaning meaning,
              SceneBuilder& builder) {
  const std::string& uri = document.model.images[image].uri;
  if (uri.empty())
    return builder.add_texture({document.path, static_cast<int>(image)}, name_of(document, image),
                               embedded_image(document, image), space, meaning);
  const auto file = builder.files.find(uri, document.path);
  if (!file) throw InputError("no such file: " + printable(uri));
  return builder.add_texture(file->path, space, meaning);
}

/// An image and, beside or above it, its mirror image: repeated, it is the image mirrored at its borders.
Texture with_mirror_images(const Texture& image, bool beside, bool above) {
  const auto w = static_cast<std::size_t>(image.width), h = static_cast<std::size_t>(image.height);
  const auto channels = static_cast<std::size_t>(image.channels);
  const std::size_t width = beside ? 2 * w : w, height = above ? 2 * h : h;
  const auto copy = [&]<class T>(const std::vector<T>& from) {
    std::vector<T> to;
    if (from.empty()) return to;
    to.reserve(width * height * channels);
    for (std::size_t y = 0; y < height; ++y)
      for (std::size_t x = 0; x < width; ++x) {
        const std::size_t row = !above ? y : y < h ? h - 1 - y : y - h, column = x < w ? x : 2 * w - 1 - x;
        const auto texel = from.begin() + static_cast<std::ptrdiff_t>((row * w + column) * channels);
        to.insert(to.end(), texel, texel + image.channels);
      }
    return to;
  };
  Texture mirrored{.name = image.name,
                   .width = static_cast<int>(width),
                   .height = static_cast<int>(height),
                   .channels = image.channels,
                   .color_space = image.color_space};
  mirrored.bytes = copy(image.bytes), mirrored.floats = copy(image.floats);
  return mirrored;
}

/// Makes `map` read its image mirrored at its borders across u or v. Returns false where the image is too
/// large for that.
bool mirror(bool across_u, bool across_v, SceneBuilder& builder, TextureMap& map) {
  const int image = map.texture;
  const Texture& once = builder.scene.textures[static_cast<std::size_t>(image)];
  if (static_cast<long long>(once.width) * once.height > max_image_pixels / 4) return false;
  map.texture = builder.add_texture(fmt::format("mirrored {} {} {}", image, across_u, across_v), [&] {
    return with_mirror_images(builder.scene.textures[static_cast<std::size_t>(image)], across_u, across_v);
  });
  const bool across[] = {across_u, across_v};
  for (std::size_t axis = 0; axis < 2; ++axis)
    if (across[axis]) map.scale[axis] /= 2, map.offset[axis] /= 2;
  return true;
}

void set_wrap(const GltfDocument& document, int sampler, std::size_t texture, SceneBuilder& builder,
              TextureMap& map) {
  if (sampler < 0) return;
  const tinygltf::Sampler& s = document.at(document.model.samplers, sampler, "samplers", "textures", texture);
  const auto warn = [&](const char* what) {
    document.warn(builder.warnings, "samplers", static_cast<std::size_t>(sampler), what);
  };
  const auto is = [&s](int wrap) { return std::pair{s.wrapS == wrap, s.wrapT == wrap}; };
  const auto [mirrors_u, mirrors_v] = is(TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT);
  const auto [clamps_u, clamps_v] = is(TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE);
  map.clamp = clamps_u && clamps_v;
  if ((mirrors_u || mirrors_v) && !mirror(mirrors_u, mirrors_v, builder, map))
    warn("an image of more than 2^26 pixels is not mirrored but repeated");
  if (clamps_u != clamps_v)
    warn("an image that is clamped one way and repeated the other is repeated both ways");
  if (s.magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST)
    warn("images are interpolated between texels, whatever the filter");
}

}  // namespace

GltfTextureUse texture_use(const tinygltf::TextureInfo& info) {
  return make_use(info.index, info.texCoord, find_extension(info.extensions, transform_extension));
}

GltfTextureUse texture_use(const tinygltf::NormalTextureInfo& info) {
  return make_use(info.index, info.texCoord, find_extension(info.extensions, transform_extension));
}

GltfTextureUse texture_use(const tinygltf::Value* extension, const char* key) {
  const tinygltf::Value* info = find_value(extension, key);
  return make_use(integer_in(info, "index", -1), integer_in(info, "texCoord", 0),
                  find_value(find_value(info, "extensions"), transform_extension));
}

std::string_view embedded_image(const GltfDocument& document, std::size_t image) {
  const tinygltf::Image& i = document.model.images[image];
  if (i.bufferView >= 0) return bytes_of_view(document, i.bufferView, "images", image);
  if (i.image.empty()) document.fail("images", image, "has no bytes");
  return {reinterpret_cast<const char*>(i.image.data()), i.image.size()};
}

std::optional<TextureMap> make_map(const GltfDocument& document, const GltfTextureUse& use,
                                   const GltfUvs& uvs, ColorSpace space, std::size_t material,
                                   SceneBuilder& builder, TextureMeaning meaning) {
  if (!use.used()) return std::nullopt;
  const auto leave_out = [&](const std::string& what) {
    document.warn(builder.warnings, "materials", material, what);
    return std::nullopt;
  };
  if (use.uv_set != uvs.set)
    return leave_out(
        fmt::format("an image on TEXCOORD_{} is left out, as others are on TEXCOORD_{}: a triangle "
                    "has one set of texture coordinates",
                    use.uv_set, uvs.set));
  const bool turned_with_mesh = same_turn(use.transform, uvs.turn);
  if (!turned_with_mesh && (use.transform.turns() || uvs.turn.turns()))
    return leave_out("an image is left out that is turned otherwise than another of the same material");
  const tinygltf::Texture& texture =
      document.at(document.model.textures, use.texture, "textures", "materials", material);
  const auto number = static_cast<std::size_t>(use.texture);
  if (texture.source < 0) return leave_out("an image is left out whose format an extension says");
  document.at(document.model.images, texture.source, "images", "textures", number);
  TextureMap map;
  if (!turned_with_mesh) place_on_mesh(use.transform, map);
  try {
    map.texture = add_image(document, static_cast<std::size_t>(texture.source), space, meaning, builder);
  } catch (const InputError& error) {
    return leave_out(fmt::format("an image is left out: {}", error.what()));
  }
  set_wrap(document, texture.sampler, number, builder, map);
  return map;
}

}  // namespace castray
