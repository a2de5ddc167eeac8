#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "castray/image.h"
#include "castray/material.h"

namespace castray {

/// A texture of a file's values: its bytes, to be decoded as `space` says, or its floats, decoded so where
/// the file holds encoded values. Alpha is linear.
Texture make_texture(std::string name, Raster&& raster, ColorSpace space);

/// A texture of linear values.
Texture make_texture(std::string name, const Image& image);

/// What a texture's bytes stand for.
const std::array<float, 256>& byte_values(ColorSpace space);

/// Red, green, blue or alpha (0 to 3) of a texel, linear.
inline float texel_channel(const Texture& texture, std::size_t index, std::size_t channel) {
  const auto channels = static_cast<std::size_t>(texture.channels);
  if (channel == 3 && channels % 2 != 0) return 1;
  const std::size_t i = index * channels + (channel == 3 ? channels - 1 : channels < 3 ? 0 : channel);
  if (texture.bytes.empty()) return texture.floats[i];
  return channel == 3 ? static_cast<float>(texture.bytes[i]) / 255.f
                      : byte_values(texture.color_space)[texture.bytes[i]];
}

/// Red, green, blue and alpha, linear.
using Texel = std::array<float, 4>;
Texel texel(const Texture& texture, std::size_t index);

/// The greatest red, green or blue value.
float greatest_value(const Texture& texture);

/// The mean over the texture's area of what a map makes of a colour.
Vec3d mean_color(const Texture& texture, const TextureMap& map);

/// The four texels around a point, in rows from the top, and the point's place between their centres.
template <class T>
struct TexelSquare {
  const Texture& texture;
  std::size_t index[2][2];
  T s, t;

  T texel(int row, int column, std::size_t channel) const {
    return T(texel_channel(texture, index[row][column], channel));
  }

  /// How the value changes per texel, to the right and downwards.
  std::array<T, 2> gradient(std::size_t channel) const {
    const auto at = [&](int row, int column) { return texel(row, column, channel); };
    return {(at(0, 1) - at(0, 0)) * (T(1) - t) + (at(1, 1) - at(1, 0)) * t,
            (at(1, 0) - at(0, 0)) * (T(1) - s) + (at(1, 1) - at(0, 1)) * s};
  }

  /// Bilinear.
  T value(std::size_t channel) const {
    const T top = texel(0, 0, channel) * (T(1) - s) + texel(0, 1, channel) * s;
    const T bottom = texel(1, 0, channel) * (T(1) - s) + texel(1, 1, channel) * s;
    return top * (T(1) - t) + bottom * t;
  }
};

/// x - floor(x), in [0,1]; 0 where x is so large or so odd that it has no fraction.
template <class T>
T fraction(T x) {
  const T f = x - std::floor(x);
  return f >= 0 && f <= 1 ? f : T(0);
}

/// Around (u,v) of the mesh, v upwards.
template <class T>
TexelSquare<T> texels_around(const Texture& texture, const TextureMap& map, T u, T v) {
  const bool clamp = map.clamp;
  const auto inside = [clamp](T x) { return clamp ? (x > 0 ? std::min(x, T(1)) : T(0)) : fraction(x); };
  const auto index = [clamp](T x, int size) {
    const int i = static_cast<int>(x), last = size - 1;
    return static_cast<std::size_t>(i < 0 ? (clamp ? 0 : last) : i > last ? (clamp ? last : 0) : i);
  };
  const T x = inside(T(map.scale[0]) * u + T(map.offset[0])) * static_cast<T>(texture.width) - T(0.5);
  const T y =
      (T(1) - inside(T(map.scale[1]) * v + T(map.offset[1]))) * static_cast<T>(texture.height) - T(0.5);
  const T x0 = std::floor(x), y0 = std::floor(y);
  TexelSquare<T> square{texture, {}, x - x0, y - y0};
  for (int row = 0; row < 2; ++row)
    for (int column = 0; column < 2; ++column)
      square.index[row][column] =
          index(y0 + T(row), texture.height) * static_cast<std::size_t>(texture.width) +
          index(x0 + T(column), texture.width);
  return square;
}

/// What a map makes of a colour whose linear channels `value_of` gives.
template <class T, class ValueOf>
Vec3<T> picked(const TextureMap& map, ValueOf value_of) {
  const auto value = [&](std::size_t channel) { return T(map.base) + T(map.gain) * value_of(channel); };
  switch (map.channel) {
    case Channel::color:
      return {value(0), value(1), value(2)};
    case Channel::luminance:
      return Vec3<T>(luminance(Vec3<T>(value(0), value(1), value(2))));
    default:
      return Vec3<T>(value(static_cast<std::size_t>(map.channel) - static_cast<std::size_t>(Channel::red)));
  }
}

/// What a map makes of a number that one texel holds.
inline float number_of_texel(const Texel& texel, TextureMap map) {
  if (map.channel == Channel::color) map.channel = Channel::luminance;
  return picked<float>(map, [&](std::size_t channel) { return texel[channel]; }).x;
}

/// What a map makes of a colour, at (u,v) of the mesh.
template <class T>
Vec3<T> map_color(const Texture& texture, const TextureMap& map, T u, T v) {
  const TexelSquare<T> square = texels_around(texture, map, u, v);
  return picked<T>(map, [&](std::size_t channel) { return square.value(channel); });
}

/// What a map makes of a number.
template <class T>
T map_number(const Texture& texture, TextureMap map, T u, T v) {
  if (map.channel == Channel::color) map.channel = Channel::luminance;
  return map_color(texture, map, u, v).x;
}

/// The normal that a map holds, in the frame of the texture coordinates; of no particular length.
template <class T>
Vec3<T> map_normal(const Texture& texture, const TextureMap& map, T u, T v) {
  const TexelSquare<T> square = texels_around(texture, map, u, v);
  const auto component = [&](std::size_t channel) { return 2 * square.value(channel) - T(1); };
  const auto along = [&](std::size_t axis) { return std::copysign(T(map.gain), T(map.scale[axis])); };
  return {component(0) * along(0), component(1) * along(1), component(2)};
}

/// How a map's number changes with u and v.
template <class T>
std::array<T, 2> map_gradient(const Texture& texture, const TextureMap& map, T u, T v) {
  const TexelSquare<T> square = texels_around(texture, map, u, v);
  const auto gradient = [&](std::size_t channel) { return square.gradient(channel); };
  std::array<T, 2> g;
  if (map.channel == Channel::color || map.channel == Channel::luminance) {
    const auto r = gradient(0), green = gradient(1), b = gradient(2);
    for (std::size_t i = 0; i < 2; ++i) g[i] = luminance(Vec3<T>(r[i], green[i], b[i]));
  } else {
    g = gradient(static_cast<std::size_t>(map.channel) - static_cast<std::size_t>(Channel::red));
  }
  return {g[0] * T(map.gain) * T(map.scale[0]) * static_cast<T>(texture.width),
          -g[1] * T(map.gain) * T(map.scale[1]) * static_cast<T>(texture.height)};
}

}  // namespace castray
