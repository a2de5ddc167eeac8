#pragma once

#include "lights/emission_cells_lanes.h"
#include "lights/environment_lanes.h"
#include "lights/light_share_lanes.h"
#include "lights/lights_lanes.h"
#include "materials/normals_lanes.h"
#include "materials/stretch_lanes.h"
#include "materials/surface_values_lanes.h"
#include "wavefront/context_lanes.h"
#include "wavefront/radiance_lanes.h"
#include "wavefront/shading_lanes.h"

namespace castray::CASTRAY_ISA {

/// MIS weight of light found by BSDF sampling with pdf `arrival`, where light sampling has pdf
/// `light_pdf`, both per solid angle. See Paths::arrival.
CASTRAY_INLINE Float found_weight(Float arrival, Float light_pdf) {
  return select(arrival >= Float(counts_all), Float(1.f), bsdf_share(light_pdf, arrival));
}

/// MIS-weighted emission of surfaces hit at `distance`; `cosine` is of the ray and the normal. For
/// `relative_density` see the function of that name.
template <uint32_t features>
CASTRAY_INLINE Vec found_emission(const KernelScene& scene, Uint material, const Parameters<features>& p,
                                  Mask front, Float arrival, Float distance, Float cosine,
                                  Float relative_density) {
  const FoundLight found = found_light(scene.materials, material, front);
  Vec emission = found.emission;
  if constexpr (features & feature_detail) emission = p.vec(slot_emission);
  const Float weight =
      found_weight(arrival, found.density * relative_density * distance * distance / abs(cosine));
  return select(found.shines, emission * weight, black());
}

/// MIS-weighted radiance from outside the scene along d.
CASTRAY_INLINE Vec escaped_radiance(const EnvironmentTable& environment, const Vec& d, Float arrival) {
  const EscapedLight sky = light_from(environment, d);
  const Mask sampled = sky.density > Float(0.f);
  if (none(sampled)) return sky.radiance;
  return select(sampled, sky.radiance * found_weight(arrival, sky.density), sky.radiance);
}

/// What pixels see of the planes around these points of triangles.
template <class Placement>
CASTRAY_INLINE Footprint footprint_at(const TriangleTable& triangles, const Placement& placement,
                                      const TrianglePlace& at, const SurfacePoint& x,
                                      const PixelView& pixel) {
  const UvDerivatives move = uv_derivatives(triangles, placement, at.triangle);
  const MapInputs in = map_inputs(triangles, at);
  const Vec across_u = cross(move.dv, x.normal), across_v = cross(x.normal, move.du);
  const Float inverse = Float(1.f) / dot(move.du, across_u);
  Footprint seen = footprint_of(pixel, x.p, x.normal, in.u, in.v, across_u * inverse, across_v * inverse);
  seen.valid = seen.valid & move.valid;
  return seen;
}

/// What materials are at these points, of which some are glass (glass_number).
CASTRAY_INLINE Uint at_points(const KernelScene& scene, Uint material, uint32_t world,
                              const SurfaceHit& hit) {
  const Uint in_instance = hash_combine(glass_world(Uint(world)), hit.instance);
  const Uint hash = point_hash(in_instance, hit.primitive, as_uint(hit.b1), as_uint(hit.b2));
  const Mask is_glass = to_unit(hash) < gather(scene.glass, &KernelMaterial::glass_share, material);
  return select(is_glass, gather(scene.glass, &KernelMaterial::glass, material), material);
}

/// Path vertices at the hits. Rays that miss add the environment's radiance and end. `see_emission`: hits
/// add emission. With `keep_misses` every path keeps its entry: a miss is a black vertex with normal
/// (0,0,0). `from_light`: whatever side of the shading normal a path comes from, its vertex has that normal
/// (see light_normals_lanes.h). `views`: those of the pixels whose camera rays these are, or null.
template <class Geometry, uint32_t features, bool keep_misses>
CASTRAY_STAGE void surfaces(const Context& c, const Paths& paths, const Hits& hits, bool see_emission,
                            Vertices& out, Radiance& radiance, bool from_light = false,
                            const PixelViews* views = nullptr) {
  const KernelScene& scene = c.scene;
  const Geometry geometry = geometry_of<Geometry>(c);
  out.count = 0;
  for (int i = 0; i < paths.count; i += width) {
    const Mask active = first_lanes(paths.count - i);
    const Uint found = load(hits.primitive + i);
    const Mask hit = active & ~(found == Uint(no_hit));
    const Uint primitive = select(hit, found, Uint(0u));
    const Vec o = load(paths.o, i), d = load(paths.d, i), throughput = load(paths.throughput, i);
    const Float t = load(hits.t + i), b1 = load(hits.b1 + i), b2 = load(hits.b2 + i);
    const SurfaceHit at{t, b1, b2, primitive, select(hit, load(hits.instance + i), Uint(0u))};
    const SurfacePoint x = geometry.surface_point(o, d, at);
    const Float towards = dot(x.normal, d);
    const Mask front = towards < Float(0.f);
    Uint material = x.material * uint32_t{material_floats};
    if (scene.pairs) material = select(front, material, gather(scene.pairs, &KernelMaterial::back, material));
    if (scene.glass) material = at_points(scene, material, c.world, at);
    const Vec facing = select(front, x.normal, -x.normal);
    const TrianglePlace place{primitive, b1, b2};
    Parameters<features> parameters = gather_parameters<features>(scene, material);
    if constexpr (features & feature_detail) {
      const TriangleTable& triangles = scene.geometry.tree.triangles;
      Footprint seen;
      if (views) seen = footprint_at(triangles, geometry.placement(at), place, x, load(*views, i));
      resolve_values(scene, triangles, material, place, views ? &seen : nullptr, parameters.value);
    }
    const Float arrival = load(paths.arrival + i);
    Mask lit = active & ~hit;
    Vec arriving = escaped_radiance(scene.lights.environment, d, abs(arrival));
    if (see_emission) {
      const Mask counts = hit & (arrival > Float(0.f)) & has_traits(scene, material, trait_emits);
      if (any(counts)) {
        const LightRegions& regions = scene.lights.regions;
        Float relative(1.f);
        if (c.options.mis && regions.tree)
          relative = relative_density(regions, o, d, gather(regions.node_of_primitive, primitive));
        if (scene.lights.cells.first) relative *= cell_share(scene.lights.cells, primitive, b1, b2);
        const Vec emission =
            found_emission(scene, material, parameters, front, arrival, t, towards, relative);
        arriving = select(counts, emission, arriving);
        lit = lit | counts;
      }
    }
    // Of both at once: paths of one pixel are to be added in their order, whatever the width.
    radiance.add(paths.names.slot + i, lit, throughput * arriving);
    const Mask kept = keep_misses ? active : hit;
    const int n = out.count;
    if constexpr (features & feature_materials) {
      const Vec to_viewer = -normalize(d);
      Vec shading_normal = facing;
      if constexpr (features & feature_detail) {
        const TriangleTable& triangles = scene.geometry.tree.triangles;
        const auto placement = geometry.placement(at);
        const Vec viewer = from_light ? facing : to_viewer;
        shading_normal = smooth_normal(triangles, placement, place, facing, viewer);
        bend_normals(scene, triangles, placement, material, place, front, facing, viewer, shading_normal);
        if (scene.stretched)
          lay_lobes(scene, triangles, placement, material, place, front, facing, shading_normal,
                    parameters.value);
      }
      compress_store(out.wo, n, kept, to_viewer);
      compress_store(out.shading_normal, n, kept, shading_normal);
      compress_store(out.error + n, kept, x.error);
      compress_store(out.eta2 + n, kept, load(paths.eta2 + i));
      if (scene.absorbing) compress_store(out.media + n, kept, load(paths.media + i));
    }
    const auto or_black = [&](Vec v) { return keep_misses ? select(hit, v, black()) : v; };
    compress_store(out.p, n, kept, or_black(fma(facing, x.error, x.p)));
    compress_store(out.normal, n, kept, or_black(facing));
    if constexpr (keep_misses)
      for (Float& v : parameters.value) v = select(hit, v, Float(0.f));
    compress_store(out.parameters, n, kept, parameters);
    compress_store(out.throughput, n, kept, or_black(throughput));
    compress_store(out.material + n, kept, material | select(front, Uint(seen_from_front), Uint(0u)));
    compress_entries(out.names, n, kept, paths.names, i);
    out.count += count(kept);
  }
}

}  // namespace castray::CASTRAY_ISA
