#pragma once

#include "lights/light_point_lanes.h"
#include "wavefront/context_lanes.h"
#include "wavefront/tint_lanes.h"

// Absorption by distance inside glass (materials/media.h, in lanes). Each segment of a path counts it once:
// segments that a ray is traced along when it hits, in `absorb`; connections to light points, and what pixels
// gather, where these are made. What a tile's pixels gather from the end of a suffix is dimmed for each pixel
// by its own distance, so the suffix's first segment is not.

namespace castray::CASTRAY_ISA {

/// Media of paths: the low 16 bits have KernelMaterial::medium of the body that a path is in, 0 for none, the
/// high ones that of the body around that.
inline constexpr uint32_t inner_medium = 0xffffu;

/// Length of a segment that leaves the scene.
inline constexpr float endless = 0x1p60f;

/// e^-x for x >= 0, within 2^-22; not less than 2^-127. By powers of two, and Taylor's series between them.
CASTRAY_INLINE Float exp_of_minus(Float x) {
  const Float y = min(x * Float(1.44269504f), Float(126.f));
  const Uint power = to_uint(y + Float(0.5f));
  const Float f = (to_float(power) - y) * Float(0.693147181f);
  constexpr float coefficient[] = {1.f / 120, 1.f / 24, 1.f / 6, 0.5f, 1.f, 1.f};
  Float series(1.f / 720);
  for (const float next : coefficient) series = fma(series, f, Float(next));
  return series * as_float((Uint(127u) - power) << 23);
}

/// What light keeps over a distance in the innermost of these media.
CASTRAY_INLINE Vec transmittance(const KernelScene& scene, Uint media, Float distance) {
  const Uint medium = media & inner_medium;
  const Mask inside = ~(medium == Uint(0u));
  const Vec one{Float(1.f), Float(1.f), Float(1.f)};
  if (none(inside)) return one;
  const Uint record = select(inside, medium - Uint(1u), Uint(0u)) * uint32_t{material_floats};
  const Vec depth = gather_vec(scene.absorbing, &KernelMaterial::absorption, record) * distance;
  return select(inside, Vec{exp_of_minus(depth.x), exp_of_minus(depth.y), exp_of_minus(depth.z)}, one);
}

/// The same along the segment from a vertex to a light point.
CASTRAY_INLINE Vec transmittance(const KernelScene& scene, Uint media, const LightPoint& light,
                                 const LightSegment& segment) {
  return transmittance(scene, media,
                       select(light.infinite, Float(endless), Float(1.f) / segment.inverse_distance));
}

/// The media on wi's side of vertices i to i + width - 1.
CASTRAY_INLINE Uint media_towards(const KernelScene& scene, const Vertices& v, int i, const Vec& wi) {
  const Mask active = first_lanes(v.count - i);
  const Uint media = select(active, load(v.media + i), Uint(0u)),
             material = select(active, load(v.material + i), Uint(0u));
  const Uint medium = gather(scene.materials, &KernelMaterial::medium, record_of(material));
  const Mask crosses = ~(medium == Uint(0u)) & (dot(wi, load(v.normal, i)) < Float(0.f));
  const Mask enters = (material >> 31) == Uint(1u);
  return select(crosses, select(enters, media << 16 | medium, media >> 16), media);
}

/// What windows and absorption leave along the rays of paths, to their hits. What hits glass from within was
/// inside it, even if the camera or a lamp is there too. `to_be_gathered`: first segments of suffixes.
template <class Geometry>
CASTRAY_STAGE void absorb(const Context& c, const Hits& hits, bool to_be_gathered, Paths& paths) {
  tint<Geometry>(c, hits, to_be_gathered, paths);
  if (!c.scene.absorbing) return;
  const Geometry geometry = geometry_of<Geometry>(c);
  for (int i = 0; i < paths.count; i += width) {
    const Uint found = load(hits.primitive + i);
    const Mask active = first_lanes(paths.count - i), hit = active & ~(found == Uint(no_hit));
    const Vec d = load(paths.d, i);
    const SurfaceHit at{load(hits.t + i), load(hits.b1 + i), load(hits.b2 + i), select(hit, found, Uint(0u)),
                        select(hit, load(hits.instance + i), Uint(0u))};
    const SurfacePoint x = geometry.surface_point(load(paths.o, i), d, at);
    const Uint record = x.material * uint32_t{material_floats};
    const Uint medium = gather(c.scene.materials, &KernelMaterial::medium, record);
    const Mask from_within = hit & ~(medium == Uint(0u)) & ~(dot(x.normal, d) < Float(0.f));
    const Uint before = select(active, load(paths.media + i), Uint(0u));
    const Uint media = select(from_within, (before & ~inner_medium) | medium, before);
    const Float distance = select(hit, at.t * sqrt(length_squared(d)), Float(endless));
    Vec kept = transmittance(c.scene, media, distance);
    if (to_be_gathered)
      kept = select(hit & has_traits(c.scene, record, trait_shareable),
                    Vec{Float(1.f), Float(1.f), Float(1.f)}, kept);
    store(paths.media + i, media);
    store(paths.throughput, i, load(paths.throughput, i) * kept);
  }
}

}  // namespace castray::CASTRAY_ISA
