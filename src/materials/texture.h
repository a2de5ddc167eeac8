#pragma once

#include <algorithm>
#include <cmath>

#include "castray/scene.h"

namespace castray {

/// Bilinear look-up at (u,v), v upwards, repeated over the plane; texel centres are at half integers.
template <class T>
Vec3<T> lookup(const Texture& texture, T u, T v) {
  const auto wrap = [](T x, int size) {
    const int i = static_cast<int>(x) % size;
    return static_cast<std::size_t>(i < 0 ? i + size : i);
  };
  const T x = (u - std::floor(u)) * static_cast<T>(texture.width) - T(0.5);
  const T y = (T(1) - (v - std::floor(v))) * static_cast<T>(texture.height) - T(0.5);
  const T x0 = std::floor(x), y0 = std::floor(y);
  const auto texel = [&](T tx, T ty) {
    const std::size_t row = wrap(ty, texture.height) * static_cast<std::size_t>(texture.width);
    return Vec3<T>(texture.texels[row + wrap(tx, texture.width)]);
  };
  const T s = x - x0, t = y - y0;
  const Vec3<T> top = texel(x0, y0) * (T(1) - s) + texel(x0 + 1, y0) * s;
  const Vec3<T> bottom = texel(x0, y0 + 1) * (T(1) - s) + texel(x0 + 1, y0 + 1) * s;
  return top * (T(1) - t) + bottom * t;
}

}  // namespace castray
