#pragma once

#include "geometry/triangle_table_lanes.h"
#include "materials/kernel_material.h"

// Textures and smooth normals, interpolated over a triangle.

namespace castray::CASTRAY_ISA {

inline constexpr uint32_t no_corner = 0xffffffffu;

/// Rounded down, for |x| < 2^31.
CASTRAY_INLINE Float floor(Float x) {
  const Float whole = to_float(to_uint(x));
  return whole - select(whole > x, Float(1.f), Float(0.f));
}

/// x - floor(x), in [0,1]; 0 where x is so large or so odd that it has no fraction.
CASTRAY_INLINE Float fraction(Float x) {
  const Float small = select(abs(x) < Float(0x1p24f), x, Float(0.f));
  return small - floor(small);
}

/// Texels as they are read from memory: words with the bytes of all channels, the first lowest; or places of
/// the first of their floats.
CASTRAY_INLINE Uint read_texels(const KernelTexture& texture, Uint index) {
  const auto channels = (uint32_t)texture.channels;
  const Uint first = index * channels;
  if (!texture.bytes) return first;
  // a word that does not reach over the end of the image
  const Uint last = Uint((uint32_t)(texture.width * texture.height) * channels - 4u);
  const Uint from = select(first < last, first, last);
  return gather_bytes(texture.bytes, from) >> ((first - from) << 3);
}

/// Channel `c` of texels that are read.
CASTRAY_INLINE Float texel_channel(const KernelTexture& texture, Uint texels, uint32_t c) {
  const auto channels = (uint32_t)texture.channels;
  const bool has_alpha = channels % 2 == 0;
  if (c == 3 && !has_alpha) return Float(1.f);
  const uint32_t place = c == 3 ? channels - 1 : channels < 3 ? 0 : c;
  if (!texture.bytes) return gather(texture.floats, texels + place);
  const Uint byte = (texels >> (8 * place)) & 0xffu;
  return c == 3 ? to_float(byte) / Float(255.f) : gather(texture.values, byte);
}

struct Gradient {
  Float u, v;
};

/// The four texels around each lane's point, as read_texels has them, in rows from the top, and the point's
/// place between their centres.
struct TexelSquare {
  Uint texels[2][2];
  Float s, t;

  /// How the value changes per texel, to the right and downwards.
  CASTRAY_INLINE Gradient gradient(const KernelTexture& texture, uint32_t channel) const {
    const auto texel = [&](int row, int column) {
      return texel_channel(texture, texels[row][column], channel);
    };
    const Float one(1.f), a = texel(0, 0), b = texel(0, 1), c = texel(1, 0), d = texel(1, 1);
    return {(b - a) * (one - t) + (d - c) * t, (c - a) * (one - s) + (d - b) * s};
  }

  /// Bilinear.
  CASTRAY_INLINE Float value(const KernelTexture& texture, uint32_t channel) const {
    const auto texel = [&](int row, int column) {
      return texel_channel(texture, texels[row][column], channel);
    };
    const Float one(1.f);
    const Float top = texel(0, 0) * (one - s) + texel(0, 1) * s;
    const Float bottom = texel(1, 0) * (one - s) + texel(1, 1) * s;
    return top * (one - t) + bottom * t;
  }
};

/// Around (u,v) of the mesh, v upwards.
CASTRAY_INLINE TexelSquare texels_around(const KernelMap& map, Float u, Float v) {
  const KernelTexture& texture = map.texture;
  const bool clamp = map.clamp;
  const Float zero(0.f), one(1.f), w((float)texture.width), h((float)texture.height);
  const auto inside = [&](Float x) { return clamp ? select(x > zero, min(x, one), zero) : fraction(x); };
  const auto index = [&](Float i, Float size) {
    const Float before = clamp ? zero : size - one, after = clamp ? size - one : zero;
    return to_uint(select(i < zero, before, select(i >= size, after, i)));
  };
  const Float x = inside(fma(u, Float(map.scale[0]), Float(map.offset[0]))) * w - Float(0.5f);
  const Float y = (one - inside(fma(v, Float(map.scale[1]), Float(map.offset[1])))) * h - Float(0.5f);
  const Float x0 = floor(x), y0 = floor(y);
  TexelSquare square{{}, x - x0, y - y0};
  for (int row = 0; row < 2; ++row)
    for (int column = 0; column < 2; ++column)
      square.texels[row][column] =
          read_texels(texture, index(y0 + Float((float)row), h) * Uint((uint32_t)texture.width) +
                                   index(x0 + Float((float)column), w));
  return square;
}

/// What the map makes of a colour, or in x of a number.
CASTRAY_INLINE Vec map_value(const KernelMap& map, Float u, Float v) {
  const TexelSquare square = texels_around(map, u, v);
  const auto value = [&](uint32_t channel) {
    return fma(square.value(map.texture, channel), Float(map.gain), Float(map.base));
  };
  if (map.channel == Channel::color) return {value(0), value(1), value(2)};
  Float one;
  if (map.channel == Channel::luminance)
    one = luminance(Vec{value(0), value(1), value(2)});
  else
    one = value((uint32_t)map.channel - (uint32_t)Channel::red);
  return {one, one, one};
}

/// The normal that the map holds, in the frame of the texture coordinates; of no particular length.
CASTRAY_INLINE Vec map_normal(const KernelMap& map, Float u, Float v) {
  const TexelSquare square = texels_around(map, u, v);
  const auto component = [&](uint32_t channel, float along) {
    return fma(square.value(map.texture, channel), Float(2.f), Float(-1.f)) * Float(along);
  };
  const auto along = [&](int axis) { return __builtin_copysignf(map.gain, map.scale[axis]); };
  return {component(0, along(0)), component(1, along(1)), component(2, 1)};
}

/// How the map's number changes with u and v.
CASTRAY_INLINE Gradient map_gradient(const KernelMap& map, Float u, Float v) {
  const TexelSquare square = texels_around(map, u, v);
  Gradient g;
  if (map.channel == Channel::luminance) {
    const Gradient red = square.gradient(map.texture, 0), green = square.gradient(map.texture, 1),
                   blue = square.gradient(map.texture, 2);
    g = {luminance(Vec{red.u, green.u, blue.u}), luminance(Vec{red.v, green.v, blue.v})};
  } else {
    g = square.gradient(map.texture, (uint32_t)map.channel - (uint32_t)Channel::red);
  }
  return {g.u * Float(map.gain * map.scale[0] * (float)map.texture.width),
          g.v * Float(-map.gain * map.scale[1] * (float)map.texture.height)};
}

/// Points on triangles.
struct TrianglePlace {
  Uint triangle;
  Float b1, b2;

  /// Floats `axis`, of `stride` of each corner in `table`.
  CASTRAY_INLINE Float interpolate(const float* table, const Corners& corners, Mask there, uint32_t stride,
                                   uint32_t axis) const {
    const auto at = [&](Uint i) { return gather(table, select(there, i, Uint(0u)) * stride + axis); };
    return at(corners.a) * (Float(1.f) - b1 - b2) + at(corners.b) * b1 + at(corners.c) * b2;
  }
};

}  // namespace castray::CASTRAY_ISA
