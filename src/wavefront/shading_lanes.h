#pragma once

#include "materials/gather_bsdf_lanes.h"
#include "wavefront/wave_lanes.h"

namespace castray::CASTRAY_ISA {

/// BSDF, shading frame, and wo in that frame, of vertices; and the geometric normal.
struct Shading {
  Bsdf bsdf;
  Frame frame;
  Vec wo, normal;

  /// Whether a direction is on the same side of the geometric and the shading normal. Smooth normals
  /// must not let light through opaque surfaces.
  CASTRAY_INLINE Mask consistent(Vec wi, Vec local) const {
    const Mask above = dot(wi, normal) > Float(0.f), local_above = local.z > Float(0.f);
    return (above & local_above) | (~above & ~local_above);
  }
};

/// Of vertices i to i + width - 1, with this shading normal.
template <uint32_t features>
CASTRAY_INLINE Shading shading_of(const KernelScene& scene, const Vertices& v, int i, Vec shading_normal) {
  const Frame frame = make_frame(shading_normal);
  return {gather_bsdf(scene, load(v.material + i), load<features>(v.parameters, i)), frame,
          to_local(frame, load(v.wo, i)), load(v.normal, i)};
}
template <uint32_t features>
CASTRAY_INLINE Shading shading_of(const KernelScene& scene, const Vertices& v, int i) {
  return shading_of<features>(scene, v, i, load(v.shading_normal, i));
}

/// The geometric normal on wi's side.
CASTRAY_INLINE Vec normal_towards(const Vertices& v, int i, Vec wi) {
  const Vec normal = load(v.normal, i);
  return select(dot(wi, normal) < Float(0.f), -normal, normal);
}

/// Origin of a ray in direction wi: offset to wi's side of the surface.
CASTRAY_INLINE Vec leave(const Vertices& v, int i, Vec wi) {
  const Vec p = load(v.p, i), normal = load(v.normal, i);
  const Float across = select(dot(wi, normal) < Float(0.f), Float(-2.f) * load(v.error + i), Float(0.f));
  return fma(normal, across, p);
}

}  // namespace castray::CASTRAY_ISA
