#include "wavefront/suffixes_lanes.h"

#include "lights/emission_cells_lanes.h"
#include "lights/environment_lanes.h"
#include "lights/lights_lanes.h"
#include "wavefront/shading_lanes.h"

namespace castray::CASTRAY_ISA {

/// Vertices i to i + width - 1 as lights. Without MIS none shines.
CASTRAY_INLINE FoundLight light_at(const Context& c, bool emission_varies, const Vertices& v, int i) {
  const Uint material = load(v.material + i);
  const Mask front = (material >> 31) == Uint(1u);
  FoundLight found = found_light(c.scene.materials, record_of(material), front);
  if (emission_varies) found.emission = load_vec(v.parameters, slot_emission, i);
  Mask shines = found.shines & Mask(c.options.mis);
  // Where lobes are not round, how they lie may stand in the place of an emission that is 0.
  if (c.scene.stretched) shines = shines & has_traits(c.scene, record_of(material), trait_emits);
  found.emission = select(shines, found.emission, black());
  return found;
}

void keep_suffix_ends(const Context& c, bool emission_varies, Suffixes& suffixes) {
  const Vertices& y = suffixes.y;
  for (int i = 0; i < y.count; i += width) {
    const FoundLight found = light_at(c, emission_varies, y, i);
    const Float sides = select(found.both_sides, Float(2.f), Float(1.f));
    store(suffixes.light_density + i, found.density * Float((float)c.options.light_points) / sides);
    store(suffixes.emission, i, found.emission);
  }
  for (int k = 0; k < y.count; ++k) suffixes.landed[y.names.slot[k] - batch_size] = (uint32_t)k + 1;
}

/// Of the lights that rays i to i + width - 1 hit.
CASTRAY_INLINE Float share_of_cells(const Context& c, const Hits& hits, int i, Mask hit) {
  const Uint triangle = select(hit, load(hits.primitive + i), Uint(0u));
  return cell_share(c.scene.lights.cells, triangle, load(hits.b1 + i), load(hits.b2 + i));
}

void scale_by_cells(const Context& c, int rays, const Hits& hits, Suffixes& suffixes) {
  alignas(64) FloatArray share;
  int n = 0;
  for (int i = 0; i < rays; i += width) {
    const Mask hit = first_lanes(rays - i) & ~(load(hits.primitive + i) == Uint(no_hit));
    compress_store(share + n, hit, share_of_cells(c, hits, i, hit));
    n += count(hit);
  }
  for (int k = 0; k < n; ++k) suffixes.light_density[k] *= share[k];
}

void scale_light_density(const Context& c, int rays, const Hits& hits, const TileLights* lights,
                         Suffixes& suffixes) {
  int k = 0;
  for (int i = 0; i < rays; ++i) {
    if (hits.primitive[i] == no_hit) continue;
    const uint32_t node = c.scene.lights.regions.node_of_primitive[hits.primitive[i]];
    const uint32_t tile = (suffixes.y.names.slot[k] - batch_size) / tile_pixels;
    suffixes.light_density[k++] *= lights[tile].density[node];
  }
}

/// leaves_lamps of the ends y of the suffixes that went on to vertices i to i + width - 1 of z.
CASTRAY_INLINE Mask ends_leave_lamps(const Context& c, const Suffixes& suffixes, const Vertices& z, int i) {
  const Mask active = first_lanes(z.count - i);
  const Uint first((uint32_t)batch_size), slot = select(active, load(z.names.slot + i), first);
  const Uint entry = select(active, gather(suffixes.landed, slot - first) - Uint(1u), Uint(0u));
  return active & leaves_lamps(c, slot, record_of(gather(suffixes.y.material, entry)));
}

void keep_found_light(const Context& c, bool emission_varies, const Paths& rays, const Hits& hits,
                      const Vertices& z, Suffixes& suffixes) {
  const LightRegions& regions = c.scene.lights.regions;
  for (int i = 0; i < z.count; i += width) {
    const Mask escaped = load(hits.primitive + i) == Uint(no_hit);
    const Vec wi = load(rays.d, i);
    const FoundLight lamp = light_at(c, emission_varies, z, i);
    const Float cosine = max(abs(dot(load(z.normal, i), wi)), Float(0x1p-60f));
    Float pdf = lamp.density * square(load(hits.t + i)) / cosine;
    if (regions.tree) {
      const Uint primitive = select(escaped, Uint(0u), load(hits.primitive + i));
      const Uint node = gather(regions.node_of_primitive, primitive);
      pdf = pdf * relative_density(regions, load(rays.o, i), wi, node);
    }
    if (c.scene.lights.cells.first) pdf *= share_of_cells(c, hits, i, ~escaped);
    const EscapedLight sky = light_from(c.scene.lights.environment, wi);
    const Vec outside = select((sky.density > Float(0.f)) & Mask(c.options.mis), sky.radiance, black());
    const Vec emission = select(ends_leave_lamps(c, suffixes, z, i), black(), lamp.emission);
    keep_of_suffixes(suffixes.found, z, i, select(escaped, outside, emission) * load(rays.throughput, i));
    keep_of_suffixes(suffixes.onward.pdf, z, i, select(escaped, sky.density, pdf));
  }
}

/// Turns vertex k, the end of a suffix, into a vertex of the path of the suffix's own pixel.
CASTRAY_INLINE void make_private(const Vertices& x, const Suffixes& suffixes, Vertices& vertices, int k) {
  const uint32_t suffix = vertices.names.slot[k] - batch_size, origin = suffixes.origin[suffix];
  vertices.names.slot[k] = origin;
  vertices.throughput.x[k] *= suffixes.weight.x[suffix] * x.throughput.x[origin];
  vertices.throughput.y[k] *= suffixes.weight.y[suffix] * x.throughput.y[origin];
  vertices.throughput.z[k] *= suffixes.weight.z[suffix] * x.throughput.z[origin];
}

void split_suffixes(const KernelScene& scene, const Vertices& x, Suffixes& suffixes, Vertices& glossy,
                    Vertices& others) {
  const Vertices& y = suffixes.y;
  glossy.count = others.count = 0;
  for (int i = 0; i < y.count; i += width) {
    const Mask active = first_lanes(y.count - i);
    const Uint record = select(active, record_of(load(y.material + i)), Uint(0u));
    const Mask shareable = has_traits(scene, record, trait_shareable);
    const Mask rough = active & shareable & has_traits(scene, record, trait_directional);
    store(suffixes.glossy + i, select(rough, Uint(1u), Uint(0u)));
    compress_entries<VertexArrays>(glossy, glossy.count, rough, y, i);
    glossy.count += count(rough);
    compress_entries<VertexArrays>(others, others.count, active & ~rough, y, i);
    alignas(64) uint32_t is_private[width];
    compress_store(is_private, active & ~rough, select(shareable, Uint(0u), Uint(1u)));
    const int n = count(active & ~rough);
    for (int k = 0; k < n; ++k)
      if (is_private[k]) make_private(x, suffixes, others, others.count + k);
    others.count += n;
  }
}

void split_chains(const KernelScene& scene, Vertices& camera, Vertices& out) {
  out.count = 0;
  for (int i = 0; i < camera.count; i += width) {
    const Uint record = record_of(load(camera.material + i));
    const Vec normal = load(camera.normal, i);
    const Mask alone =
        first_lanes(camera.count - i) & (length_squared(normal) > Float(0.f)) & ~gathers(scene, record);
    if (none(alone)) continue;
    compress_entries<VertexArrays>(out, out.count, alone, camera, i);
    out.count += count(alone);
    store(camera.normal, i, select(alone, black(), normal));
    store_kd(camera.parameters, i, select(alone, black(), load_kd(camera.parameters, i)));
  }
}

}  // namespace castray::CASTRAY_ISA
