#pragma once

#include "cameras/camera_lanes.h"
#include "materials/stretch_lanes.h"
#include "wavefront/light_normals_lanes.h"
#include "wavefront/trace_lanes.h"

namespace castray::CASTRAY_ISA {

/// What light paths start with, by slot. Of colours greatest components.
struct Emissions {
  VecArray<batch_size> p;
  alignas(64) float flux[batch_size];      ///< of what the path carries, over the pixels of the image
  alignas(64) float radiance[batch_size];  ///< of the light
};

/// Camera rays to the vertices of light paths, and what the camera sees there.
struct CameraConnections {
  Paths rays;  ///< slot: the entry of the vertex
  Hits hits;
  alignas(64) UintArray x, y;           ///< pixel
  alignas(64) FloatArray density;       ///< SeenPoint::pixels_per_solid_angle
  VecArray<capacity> splat, by_chance;  ///< as in Splats
};

/// Starts a camera ray to each vertex in the image that may reflect light to the camera; mirrors, glass and
/// surfaces that focus are left to paths from the camera. `vertex`: their number in their paths.
CASTRAY_STAGE inline void aim_camera(const Context& c, const LightPathJob& job, uint32_t vertex,
                                     const Vertices& vertices, CameraConnections& out) {
  const KernelCamera& camera = c.scene.camera;
  const Vec one{Float(1.f), Float(1.f), Float(1.f)};
  Paths& rays = out.rays;
  rays.count = 0;
  for (int i = 0; i < vertices.count; i += width) {
    const Vec p = load(vertices.p, i);
    const Numbers<2> lens = camera.has_lens ? draw<2>(c.options.sobol, sequence_of(vertices.names, i),
                                                      PathBlocks::lens_of_light_path(vertex))
                                            : Numbers<2>{Float(0.f), Float(0.f)};
    const SeenPoint at = see_point(camera, p, lens.u[0], lens.u[1]);
    const Mask active = first_lanes(vertices.count - i);
    const Uint record = records_of(vertices, i);
    const Mask seen =
        active & ~has_traits(c.scene, record, trait_transmits) & ~has_traits(c.scene, record, trait_focuses) &
        (dot(load(vertices.normal, i), p - at.origin) < Float(0.f)) &
        (at.pixels_per_solid_angle > Float(0.f)) & (at.px >= Float(0.f)) & (at.py >= Float(0.f)) &
        (at.px < Float((float)job.width)) & (at.py < Float((float)job.height));
    const int n = rays.count;
    compress_store(rays.o, n, seen, at.origin);
    compress_store(rays.d, n, seen, p - at.origin);
    compress_store(rays.throughput, n, seen, one);
    compress_store(rays.arrival + n, seen, Float(0.f));
    compress_store(rays.eta2 + n, seen, Float(1.f));
    compress_entries(rays.names, n, seen, vertices.names, i);
    compress_store(rays.names.slot + n, seen, Uint((uint32_t)i) + lane_index());
    compress_store(out.x + n, seen, to_uint(at.px));
    compress_store(out.y + n, seen, to_uint(at.py));
    compress_store(out.density + n, seen, at.pixels_per_solid_angle);
    rays.count += count(seen);
  }
}

/// Whether the camera's ray reached the vertex, where ray parameter t is 1: its hit is on the same surface,
/// or as near as that, or beyond an edge.
CASTRAY_INLINE Mask reaches(Uint found, Uint aimed_at, Float t) {
  constexpr float nearly = 1 - 0x1p-18f;
  return (found == Uint(no_hit)) | (found == aimed_at) | (t >= Float(nearly));
}

/// The radiance that the vertices of light paths send to the camera, as a splat each. `hits`: where they are.
template <class Geometry, uint32_t features>
CASTRAY_STAGE void connect_camera(Context& c, const LightPathJob& job, uint32_t vertex,
                                  const Vertices& vertices, const Hits& hits, const Emissions& emissions,
                                  CameraConnections& to) {
  aim_camera(c, job, vertex, vertices, to);
  closest<Geometry>(c, to.rays, true, to.hits);
  Tints tints;
  if (has_tints(c)) find_tints<Geometry>(c, to.rays.o, to.rays.d, c.ends.one, to.rays.count, nullptr, tints);
  for (int i = 0; i < to.rays.count; i += width) {
    const Mask active = first_lanes(to.rays.count - i);
    const Uint entry = select(active, load(to.rays.names.slot + i), Uint(0u));
    const Vec d = load(to.rays.d, i), normal = gather_entries(vertices.normal, entry);
    const Vec wo = -normalize(d), wi = gather_entries(vertices.wo, entry);
    const Vec kept = gather_entries(vertices.shading_normal, entry);
    Vec shading_normal = kept;
    if constexpr (features & feature_detail) shading_normal = normal_seen_from(kept, normal, wo);
    const Frame frame = make_frame(shading_normal);
    Bsdf bsdf = gather_bsdf(c.scene, gather(vertices.material, entry),
                            gather_entries<features>(vertices.parameters, entry));
    if constexpr (features & feature_detail)
      if (c.scene.stretched) relay_lobes(active, kept, shading_normal, normal, bsdf);
    const BsdfValue value = evaluate(bsdf, to_local(frame, wo), to_local(frame, wi));
    const Float cos_light = max(abs(dot(normal, wi)), Float(0x1p-60f));
    const Uint slot = gather(vertices.names.slot, entry);
    Vec reflected = gather_entries(vertices.throughput, entry) * value.f_cos * gather(vertices.eta2, entry);
    if (has_tints(c)) reflected = reflected * load(tints.left, i);
    const Float weight = gather(emissions.flux, slot) * load(to.density + i) * dot(normal, wo) /
                         (cos_light * length_squared(d));
    const Mask lit =
        active & reaches(load(to.hits.primitive + i), gather(hits.primitive, entry), load(to.hits.t + i));
    store(to.splat, i, select(lit, reflected * weight, black()));
    const Mask by_chance = lit & (value.pdf > Float(0.f));
    const Float over_pdf = gather(emissions.radiance, slot) / value.pdf;
    store(to.by_chance, i, select(by_chance, reflected * over_pdf, black()));
  }
}

}  // namespace castray::CASTRAY_ISA
