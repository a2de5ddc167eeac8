#pragma once

#include <array>

#include "core/warp.h"
#include "materials/kernel_material.h"
#include "materials/texture.h"

// Textures on the mean over what a pixel sees. A sample of the camera reads its image at 16 points spread
// over the pixel, and one path is followed from there: the noise of fine detail falls as if there were 16
// times as many samples. Each point is anywhere in the pixel with the same probability, so no detail is
// blurred, and the mean is that of points read one by one wherever the pixel sees one plane, evenly lit.

namespace castray {

/// The camera's ray through the middle of a pixel, o + t d, and how it changes by a pixel to the right and by
/// one downwards: ray differentials (Igehy 1999).
template <class T>
struct PixelView {
  Vec3<T> o, d, o_right, d_right, o_down, d_down;
  Point2<T> sample;  ///< where in the pixel the sample lies, in [0,1)
};

/// What a pixel sees of the plane of a triangle, in texture coordinates. Its point (x,y), both in
/// [-1/2, 1/2), is at center + (x right + y down) / (1 + x nearing_right + y nearing_down).
template <class T>
struct Footprint {
  std::array<T, 2> center, right, down;
  T nearing_right, nearing_down;
  Point2<T> sample;  ///< as in PixelView

  /// The texture coordinates of probe i: a net of points, moved with the sample and wrapped round the pixel.
  std::array<T, 2> probe(int i) const {
    const auto wrapped = [](T x) { return (x < 1 ? x : x - 1) - T(0.5); };
    const T x = wrapped(T(footprint_probe[i][0]) + sample.x),
            y = wrapped(T(footprint_probe[i][1]) + sample.y);
    const T scale = 1 / std::max(T(1) + x * nearing_right + y * nearing_down, T(least_nearing));
    const auto axis = [&](std::size_t k) { return center[k] + (x * right[k] + y * down[k]) * scale; };
    return {axis(0), axis(1)};
  }
};

/// Whether a footprint reaches over more than about a texel.
template <class T>
bool is_wide(const Footprint<T>& seen, const Texture& texture, const TextureMap& map) {
  const auto texels = [&](const std::array<T, 2>& uv) {
    return std::hypot(uv[0] * T(map.scale[0]) * static_cast<T>(texture.width),
                      uv[1] * T(map.scale[1]) * static_cast<T>(texture.height));
  };
  return texels(seen.right) > 1 || texels(seen.down) > 1;
}

/// What a map makes of a colour over a pixel's footprint; at (u,v), where the sample is, if that is hardly
/// more than a texel.
template <class T>
Vec3<T> footprint_color(const Texture& texture, const TextureMap& map, T u, T v, const Footprint<T>& seen) {
  if (!is_wide(seen, texture, map)) return map_color(texture, map, u, v);
  Vec3<T> sum;
  for (int i = 0; i < footprint_probes; ++i) {
    const auto [probe_u, probe_v] = seen.probe(i);
    sum += map_color(texture, map, probe_u, probe_v);
  }
  return sum / T(footprint_probes);
}

}  // namespace castray
