#include "wavefront/suffixes_lanes.h"

#include "lights/lights_lanes.h"
#include "wavefront/shading_lanes.h"

namespace castray::CASTRAY_ISA {

void keep_suffix_ends(const Context& c, bool emission_varies, Suffixes& suffixes) {
  const Vertices& y = suffixes.y;
  for (int i = 0; i < y.count; i += width) {
    const Uint material = load(y.material + i);
    const Mask front = (material >> 31) == Uint(1u);
    const FoundLight found = found_light(c.scene.materials, record_of(material), front);
    const Float sides = select(found.both_sides, Float(2.f), Float(1.f));
    store(suffixes.light_density + i, found.density * Float((float)c.options.light_points) / sides);
    const Vec emission = emission_varies ? load_vec(y.parameters, slot_emission, i) : found.emission;
    store(suffixes.emission, i, select(found.shines & Mask(c.options.mis), emission, black()));
  }
  for (int k = 0; k < y.count; ++k) suffixes.landed[y.names.slot[k] - batch_size] = (uint32_t)k + 1;
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

/// Turns vertex k, the end of a suffix, into a vertex of the path of the suffix's own pixel.
CASTRAY_INLINE void make_private(const Vertices& x, const Suffixes& suffixes, Vertices& vertices, int k) {
  const uint32_t suffix = vertices.names.slot[k] - batch_size, origin = suffixes.origin[suffix];
  vertices.names.slot[k] = origin;
  vertices.throughput.x[k] = suffixes.weight.x[suffix] * x.throughput.x[origin];
  vertices.throughput.y[k] = suffixes.weight.y[suffix] * x.throughput.y[origin];
  vertices.throughput.z[k] = suffixes.weight.z[suffix] * x.throughput.z[origin];
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

void split_unshareable(const KernelScene& scene, Vertices& camera, Vertices& out) {
  out.count = 0;
  for (int i = 0; i < camera.count; i += width) {
    const Uint record = record_of(load(camera.material + i));
    const Vec normal = load(camera.normal, i);
    const Mask alone = first_lanes(camera.count - i) & (length_squared(normal) > Float(0.f)) &
                       ~has_traits(scene, record, trait_shareable);
    if (none(alone)) continue;
    compress_entries<VertexArrays>(out, out.count, alone, camera, i);
    out.count += count(alone);
    store(camera.normal, i, select(alone, black(), normal));
    store_kd(camera.parameters, i, select(alone, black(), load_kd(camera.parameters, i)));
  }
}

}  // namespace castray::CASTRAY_ISA
