#pragma once

#include "materials/gather_bsdf_lanes.h"
#include "wavefront/wave_lanes.h"

namespace castray::CASTRAY_ISA {

/// The BSDF at vertices, the frame it lives in, and the viewer's direction there.
struct Shading {
  Bsdf bsdf;
  Frame frame;
  Vec wo, normal;

  /// Whether a direction is on the same side of the real surface as of the shading normal's: smooth normals
  /// must not let light through an opaque surface.
  CASTRAY_INLINE Mask consistent(Vec wi, Vec local) const {
    const Mask above = dot(wi, normal) > Float(0.f), local_above = local.z > Float(0.f);
    return (above & local_above) | (~above & ~local_above);
  }
};

template <uint32_t features>
CASTRAY_INLINE Shading shading_of(const KernelScene& scene, const Vertices& v, int i) {
  const Frame frame = make_frame(load(v.shading_normal, i));
  return {gather_bsdf(scene, load(v.material + i), load<features>(v.parameters, i)), frame,
          to_local(frame, load(v.wo, i)), load(v.normal, i)};
}

/// The normal on wi's side.
CASTRAY_INLINE Vec normal_towards(const Vertices& v, int i, Vec wi) {
  const Vec normal = load(v.normal, i);
  return select(dot(wi, normal) < Float(0.f), -normal, normal);
}

/// Where a ray in direction `wi` leaves a vertex: a point on wi's side.
CASTRAY_INLINE Vec leave(const Vertices& v, int i, Vec wi) {
  const Vec p = load(v.p, i), normal = load(v.normal, i);
  const Float across = select(dot(wi, normal) < Float(0.f), Float(-2.f) * load(v.error + i), Float(0.f));
  return fma(normal, across, p);
}

}  // namespace castray::CASTRAY_ISA
