#pragma once

#include "geometry/hit_point_lanes.h"
#include "materials/surface_values_lanes.h"
#include "wavefront/context_lanes.h"
#include "wavefront/radiance_lanes.h"
#include "wavefront/shading_lanes.h"

namespace castray::CASTRAY_ISA {

/// What the side that shines emits.
template <uint32_t features>
CASTRAY_INLINE Vec emission_of(const KernelScene& scene, Uint record, const Parameters<features>& p) {
  if constexpr (features & feature_detail) return p.vec(slot_emission);
  return gather_vec(scene.materials->value + slot_emission, record);
}

/// The part of a surface's own light that a ray counts (balance heuristic with light sampling).
CASTRAY_INLINE Vec found_emission(const KernelScene& scene, Uint material, Vec emission, Mask front,
                                  Float arrival, Float distance, Float cosine) {
  const KernelMaterial& first = *scene.materials;
  const Mask shines = front | has_traits(scene, material, trait_emits_behind);
  const Float light_pdf = gather(&first.light_density, material) * distance * distance / abs(cosine);
  const Float share =
      select(arrival >= Float(counts_all), Float(1.f), arrival / max(arrival + light_pdf, Float(0x1p-100f)));
  return select(shines, emission * share, black());
}

/// The surface at each hit. Paths that miss collect the environment and end. `see_emission`: some rays count
/// it. With `keep_misses` every path keeps its place, and a miss is a black vertex without a normal.
template <uint32_t features, bool keep_misses>
CASTRAY_INLINE void surfaces(const Context& c, const Paths& paths, const Hits& hits, bool see_emission,
                             Vertices& out, Radiance& radiance) {
  const KernelScene& scene = c.scene;
  out.count = 0;
  for (int i = 0; i < paths.count; i += width) {
    const Mask active = first_lanes(paths.count - i);
    const Uint found = load(hits.primitive + i);
    const Mask hit = active & ~(found == Uint(no_hit));
    const Uint primitive = select(hit, found, Uint(0u));
    const Vec o = load(paths.o, i), d = load(paths.d, i), throughput = load(paths.throughput, i);
    const HitPoint x = hit_point<features>(scene, o, d, hits, i, primitive);
    const Float towards = dot(x.normal, d);
    const Mask front = towards < Float(0.f);
    const Vec facing = select(front, x.normal, -x.normal);
    Parameters<features> parameters = gather_parameters<features>(scene, x.material);
    if constexpr (features & feature_detail)
      resolve_values(scene, x.material, {primitive, load(hits.b1 + i), load(hits.b2 + i)}, parameters.value);
    if (see_emission) {
      const Float arrival = load(paths.arrival + i);
      const Vec emission = found_emission(scene, x.material, emission_of(scene, x.material, parameters),
                                          front, arrival, load(hits.t + i), towards);
      radiance.add(paths.names.slot + i, hit & (arrival > Float(0.f)), throughput * emission);
    }
    radiance.add(paths.names.slot + i, active & ~hit, throughput * broadcast(scene.environment));
    const Mask kept = keep_misses ? active : hit;
    const int n = out.count;
    if constexpr (features & feature_materials) {
      const Vec to_viewer = -normalize(d);
      Vec shading_normal = facing;
      if constexpr (features & feature_detail) {
        const Float b1 = load(hits.b1 + i), b2 = load(hits.b2 + i);
        shading_normal = smooth_normal(scene.triangles, primitive, b1, b2, facing, to_viewer);
      }
      compress_store(out.wo, n, kept, to_viewer);
      compress_store(out.shading_normal, n, kept, shading_normal);
      compress_store(out.error + n, kept, x.error);
      compress_store(out.eta2 + n, kept, load(paths.eta2 + i));
    }
    const auto or_black = [&](Vec v) { return keep_misses ? select(hit, v, black()) : v; };
    compress_store(out.p, n, kept, or_black(fma(facing, x.error, x.p)));
    compress_store(out.normal, n, kept, or_black(facing));
    if constexpr (keep_misses)
      for (Float& v : parameters.value) v = select(hit, v, Float(0.f));
    compress_store(out.parameters, n, kept, parameters);
    compress_store(out.throughput, n, kept, or_black(throughput));
    compress_store(out.material + n, kept, x.material | select(front, Uint(0x80000000u), Uint(0u)));
    compress_names(out.names, n, kept, paths.names, i);
    out.count += count(kept);
  }
}

}  // namespace castray::CASTRAY_ISA
