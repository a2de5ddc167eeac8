#pragma once

#include "lights/light_records.h"
#include "simd/vec_lanes.h"

namespace castray::CASTRAY_ISA {

/// A light sample. Pdfs are per area of the light; for a point at infinity per solid angle.
struct LightPoint {
  Vec p;  ///< for a point at infinity: the unit direction to it
  Vec normal;
  Vec weight;     ///< emitted radiance over the pdf of the sample
  Float density;  ///< pdf that MIS weights take for it, times what LightRegions know: power-proportional,
                  ///< even where importance chose the light
  Mask two_sided;
  Float error;    ///< bound of the distance of p from the exact light
  Mask infinite;  ///< at infinity: `normal`, `two_sided` and `error` have no meaning
  Uint node;      ///< of the light tree's cut, for relative_density; where LightRegions are known
};

/// The segment from the surface point p to a light point.
struct LightSegment {
  Vec towards;  ///< from p to the point, not of unit length
  Vec end;      ///< the point, offset off the light by its error to p's side
  Vec normal;   ///< the light's, on p's side
  Float inverse_distance;
  Float solid_angle;  ///< cos' / |x' - x|^2, which turns densities per solid angle into those of the light
                      ///< point; 0 where the light faces away
};

/// Scene space lies within [-1,1]^3: from any point of it, this far away is outside.
inline constexpr float beyond_scene = 4;

CASTRAY_INLINE LightSegment connect_light(const LightPoint& light, const Vec& p) {
  const Vec towards = light.p - p;
  const Float facing = -dot(light.normal, towards);
  const Float cos_light = select(light.two_sided, abs(facing), max(facing, Float(0.f)));
  const Float distance2 = length_squared(towards);
  const Float inverse = Float(1.f) / sqrt(max(distance2, Float(0x1p-100f)));
  const Vec normal{flip_by_sign(light.normal.x, facing), flip_by_sign(light.normal.y, facing),
                   flip_by_sign(light.normal.z, facing)};
  LightSegment segment{towards, fma(normal, light.error, light.p), normal, inverse,
                       cos_light * inverse * inverse * inverse};
  if (any(light.infinite)) {
    const Float one(1.f);
    segment.towards = select(light.infinite, light.p, segment.towards);
    segment.end = select(light.infinite, fma(light.p, Float(beyond_scene), p), segment.end);
    segment.normal = select(light.infinite, -light.p, segment.normal);
    segment.inverse_distance = select(light.infinite, one, segment.inverse_distance);
    segment.solid_angle = select(light.infinite, one, segment.solid_angle);
  }
  return segment;
}

/// A segment as it is traced.
struct Segment {
  Vec o, d;
};

/// The segment between a light point and p, which is offset off its surface to the side of `normal`. It
/// starts at the light if something may lie close in front of that: the error of an origin is its own, that
/// of a far end grows with the distance. What is as close to p would have stopped the path before p.
template <class Geometry>
CASTRAY_INLINE Segment to_trace(const Geometry& geometry, const LightList& lights, const LightSegment& light,
                                const Vec& p, const Vec& normal) {
  if (lights.may_be_covered) return {light.end, geometry.far_end(p, normal, light.end) - light.end};
  return {p, geometry.far_end(light.end, light.normal, p) - p};
}

}  // namespace castray::CASTRAY_ISA
