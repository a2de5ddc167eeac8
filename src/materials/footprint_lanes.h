#pragma once

#include "materials/texture_lanes.h"

// materials/footprint.h in lanes.

namespace castray::CASTRAY_ISA {

struct PixelView {
  Vec o, d, o_right, d_right, o_down, d_down;
  Float sample_x, sample_y;
};

/// Where `valid`; elsewhere points are read.
struct Footprint {
  Float center[2], right[2], down[2];
  Float nearing_right, nearing_down, sample_x, sample_y;
  Mask valid;

  struct Point {
    Float u, v;
  };
  CASTRAY_INLINE Point probe(int i) const {
    const auto place = [](float probe, Float moved) {
      const Float x = Float(probe) + moved;
      return select(x < Float(1.f), x, x - Float(1.f)) - Float(0.5f);
    };
    const Float x = place(footprint_probe[i][0], sample_x), y = place(footprint_probe[i][1], sample_y);
    const Float nearing = fma(x, nearing_right, fma(y, nearing_down, Float(1.f)));
    const Float scale = Float(1.f) / max(nearing, Float(least_nearing));
    return {fma(fma(x, right[0], y * down[0]), scale, center[0]),
            fma(fma(x, right[1], y * down[1]), scale, center[1])};
  }
};

/// Of a plane with this normal through p, which has the texture coordinates (u,v); they change across it by
/// the gradients.
CASTRAY_INLINE Footprint footprint_of(const PixelView& pixel, const Vec& p, const Vec& normal, Float u,
                                      Float v, const Vec& gradient_u, const Vec& gradient_v) {
  const Float towards = dot(normal, pixel.d), t = dot(normal, p - pixel.o) / towards;
  const Vec middle = fma(pixel.d, t, pixel.o) - p;
  const auto change = [&](const Vec& o, const Vec& d) {
    const Vec w = fma(d, t, o);
    return w - pixel.d * (dot(normal, w) / towards);
  };
  const Vec right = change(pixel.o_right, pixel.d_right), down = change(pixel.o_down, pixel.d_down);
  return {{u + dot(gradient_u, middle), v + dot(gradient_v, middle)},
          {dot(gradient_u, right), dot(gradient_v, right)},
          {dot(gradient_u, down), dot(gradient_v, down)},
          dot(normal, pixel.d_right) / towards,
          dot(normal, pixel.d_down) / towards,
          pixel.sample_x,
          pixel.sample_y,
          (t > Float(0.f)) & (t < Float(__builtin_inff()))};
}

/// Whether the footprints reach over more than about a texel.
CASTRAY_INLINE Mask is_wide(const KernelMap& map, const Footprint& seen) {
  const Float w(map.scale[0] * (float)map.texture.width), h(map.scale[1] * (float)map.texture.height);
  const auto texels2 = [&](const Float(&uv)[2]) { return square(uv[0] * w) + square(uv[1] * h); };
  return seen.valid & (max(texels2(seen.right), texels2(seen.down)) > Float(1.f));
}

/// What the map makes of a colour over the footprint of each lane in `here`.
inline __attribute__((noinline)) Vec footprint_value(const KernelMap& map, const Float& u, const Float& v,
                                                     const Footprint& seen, const Mask& here) {
  const Mask wide = here & is_wide(map, seen);
  Vec value = black();
  if (any(here & ~wide)) value = map_value(map, u, v);
  if (none(wide)) return value;
  Vec sum = black();
  for (int i = 0; i < footprint_probes; ++i) {
    const Footprint::Point at = seen.probe(i);
    sum = sum + map_value(map, at.u, at.v);
  }
  return select(wide, sum * Float(1.f / footprint_probes), value);
}

}  // namespace castray::CASTRAY_ISA
