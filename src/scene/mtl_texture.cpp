#include "scene/mtl_texture.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "castray/image.h"
#include "core/text.h"
#include "materials/texture.h"
#include "scene/names.h"

namespace castray {

namespace {

Channel channel_of(char letter) {
  constexpr std::pair<char, Channel> channels[] = {{'r', Channel::red},
                                                   {'g', Channel::green},
                                                   {'b', Channel::blue},
                                                   {'m', Channel::alpha},
                                                   {'l', Channel::luminance}};
  for (const auto& [name, channel] : channels)
    if (name == letter) return channel;
  return Channel::color;
}

ColorSpace color_space_of(const std::string& name, ColorSpace usual) {
  const std::string lower = lower_case(name);
  if (lower.empty()) return usual;
  return lower.find("srgb") != lower.npos && lower.find("linear") == lower.npos ? ColorSpace::srgb
                                                                                : ColorSpace::linear;
}

/// Adds the texture that `add` makes of the statement's file; its position in the scene, or -1.
template <class Add>
int add_image(const TextureStatement& statement, SceneBuilder& builder, const Add& add) {
  const std::string what = statement.key + ": ";
  const auto warn = [&](const std::string& message, Harm harm = Harm::changes_picture) {
    builder.warnings.add(statement.place, what + message, harm);
    return -1;
  };
  const auto file = builder.files.find(statement.file, statement.place.file);
  if (!file) return warn("no such file: " + printable(statement.file));
  const std::string path = printable(file->path.string());
  if (!is_image_format(file->path)) return warn("not an image format that is read: " + path);
  if (file->elsewhere)
    warn(fmt::format("{} is not there; {} is used", printable(statement.file), path), Harm::none);
  try {
    return add(file->path);
  } catch (const InputError& error) {
    throw InputError(statement.place, what + error.what());
  }
}

/// Whether `holds` is true for one of some texels, evenly spread.
template <class Holds>
bool any_texel(const Texture& texture, const Holds& holds) {
  constexpr std::size_t most = 1 << 16;
  const std::size_t count =
      static_cast<std::size_t>(texture.width) * static_cast<std::size_t>(texture.height);
  for (std::size_t i = 0; i < count; i += 1 + count / most)
    if (holds(texel(texture, i))) return true;
  return false;
}

/// What a statement says besides its image.
TextureMap map_of(const TextureStatement& statement, SceneBuilder& builder) {
  TextureMap map;
  for (std::size_t i = 0; i < 2; ++i) {
    map.scale[i] = static_cast<float>(statement.scale[i]);
    map.offset[i] = static_cast<float>(statement.offset[i]);
  }
  map.clamp = statement.clamp;
  map.base = static_cast<float>(statement.base);
  map.gain = static_cast<float>(statement.gain);
  map.channel = channel_of(statement.channel);
  for (const std::string& option : statement.ignored_options)
    builder.ignore(statement.place.file, statement.key + " " + option);
  return map;
}

/// The image of roughness, a byte a texel, for that which `map` reads, as a factor of the exponent `ns`.
Texture roughness_image(const Texture& exponents, const TextureMap& map, double ns) {
  Texture image{.name = exponents.name,
                .width = exponents.width,
                .height = exponents.height,
                .channels = 1,
                .color_space = ColorSpace::linear};
  image.bytes.resize(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
  for (std::size_t i = 0; i < image.bytes.size(); ++i) {
    const double factor = number_of_texel(texel(exponents, i), map);
    const double roughness = std::sqrt(alpha_of_exponent(std::max(0.0, ns * factor)));
    image.bytes[i] = static_cast<std::uint8_t>(std::lround(255 * roughness));
  }
  return image;
}

}  // namespace

TextureMap read_map(const TextureStatement& statement, ColorSpace usual, TextureMeaning meaning,
                    SceneBuilder& builder) {
  TextureMap map = map_of(statement, builder);
  const ColorSpace space = color_space_of(statement.color_space, usual);
  map.texture = add_image(statement, builder, [&](const std::filesystem::path& file) {
    return builder.add_texture(file, space, meaning);
  });
  return map;
}

TextureMap read_exponent_map(const TextureStatement& statement, double ns, SceneBuilder& builder) {
  TextureMap map = map_of(statement, builder);
  const ColorSpace space = color_space_of(statement.color_space, ColorSpace::linear);
  map.texture = add_image(statement, builder, [&](const std::filesystem::path& file) {
    const std::string name = fmt::format("{}\nNs {} {} {} {} {}", file.string(), ns, map.base, map.gain,
                                         static_cast<int>(map.channel), static_cast<int>(space));
    return builder.add_texture(name, [&] {
      return roughness_image(make_texture(file.filename().string(), read_raster(file), space), map, ns);
    });
  });
  map.base = 0, map.gain = 1, map.channel = Channel::color;
  return map;
}

double alpha_of_exponent(double ns) { return std::min(1.0, std::sqrt(2 / (ns + 2))); }

bool holds_normals(const Texture& texture) {
  constexpr float coloured = 0.2f;  // what the encoding of a grey image never adds
  return any_texel(texture, [](const Texel& t) {
    const auto [low, high] = std::minmax({t[0], t[1], t[2]});
    return high - low > coloured;
  });
}

bool has_holes(const Texture& texture) {
  return texture.channels % 2 == 0 && any_texel(texture, [](const Texel& t) { return t[3] < 1; });
}

}  // namespace castray
