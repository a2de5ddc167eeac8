#pragma once

#include "wavefront/context_lanes.h"
#include "wavefront/sequence_keys_lanes.h"
#include "wavefront/shading_lanes.h"

namespace castray::CASTRAY_ISA {

/// The suffixes of a job: suffix j of tile t has slot batch_size + 64 t + j.
struct Suffixes {
  VecArray<batch_size> p, normal, emission;
  alignas(64) float light_density[batch_size];  ///< of light points at y
  alignas(64) uint32_t landed[batch_size];      ///< 0: there is no y
  alignas(64) uint32_t origin[batch_size];      ///< entry of the camera vertex it started from
  VecArray<batch_size> weight;                  ///< f cos / pdf there, times the stratum
  // Of glossy y, which reflect to each pixel what it gets by itself:
  alignas(64) uint32_t glossy[batch_size];
  VecArray<batch_size> shading_normal;
  ParameterArray<batch_size> parameters;
  alignas(64) uint32_t material[batch_size];
  VecArray<batch_size> to_light, onward;  ///< directions: to the light point, and of the next segment
};

template <int N>
CASTRAY_INLINE Vec gather_entries(const VecArray<N>& a, Uint i) {
  return {gather(a.x, i), gather(a.y, i), gather(a.z, i)};
}

/// One bounce from one pixel of each stratum.
template <uint32_t features>
CASTRAY_INLINE void start_suffixes(const Context& c, const Vertices& x, Suffixes& suffixes, Paths& out) {
  const auto per_tile = (uint32_t)c.options.suffixes;
  const uint32_t stratum = tile_pixels / per_tile;
  const int shift = __builtin_ctz(stratum);
  const Vec one{Float(1.f), Float(1.f), Float(1.f)};
  out.count = 0;
  for (int tile = 0; tile < c.job.tiles; ++tile) {
    const uint32_t key = tile_key(c, tile), choice_key = hash_once(key, (uint32_t)c.job.sample);
    for (uint32_t j = 0; j < per_tile; j += width) {
      const Uint item = Uint(j) + lane_index(), suffix = Uint((uint32_t)(tile * tile_pixels)) + item;
      const Uint in_stratum = hash_combine(Uint(choice_key), item + 0x51u) & (stratum - 1);
      const Mask there = item < Uint(per_tile);
      const Uint entry =
          Uint((uint32_t)(tile * tile_pixels)) + select(there, (item << shift) + in_stratum, Uint(0u));
      const Uint index = tile_index(key, c.job.sample, item, per_tile);
      const Numbers<4> n = draw<4>(c.options.sobol, {Uint(key), index}, direction_block(0));
      const Vec normal = gather_entries(x.normal, entry);
      const Parameters<features> parameters = gather_entries<features>(x.parameters, entry);
      Vec wi, weight = parameters.kd();
      if constexpr (features & feature_materials) {
        const Frame frame = make_frame(gather_entries(x.shading_normal, entry));
        const Shading shading{gather_bsdf(c.scene, gather(x.material, entry), parameters), frame,
                              to_local(frame, gather_entries(x.wo, entry)), normal};
        const Numbers<2> choice = draw<2>(c.options.sobol, {Uint(key), index}, choice_block(0));
        const BsdfSample s = sample(shading.bsdf, shading.wo, choice.u[1], n.u[0], n.u[1]);
        wi = to_world(frame, s.wi);
        weight = select(shading.consistent(wi, s.wi), s.weight, black());
      } else {
        wi = to_world(make_frame(normal), cosine_hemisphere(n.u[0], n.u[1]));
      }
      const Mask going =
          there & (length_squared(normal) > Float(0.f)) & ~(max_component(weight) <= Float(0.f));
      const int first = tile * tile_pixels + (int)j, k = out.count;
      store(suffixes.origin + first, entry);
      store(suffixes.landed + first, Uint(0u));
      store(suffixes.weight, first, weight * Float((float)stratum));
      compress_store(out.o, k, going, gather_entries(x.p, entry));
      compress_store(out.d, k, going, wi);
      compress_store(out.throughput, k, going, one);
      compress_store(out.arrival + k, going, Float(0.f));
      compress_store(out.eta2 + k, going, Float(1.f));
      compress_store(out.names.slot + k, going, suffix + Uint((uint32_t)batch_size));
      compress_store(out.names.key + k, going, Uint(key));
      compress_store(out.names.index + k, going, index);
      compress_store(out.names.light_u + k, going, n.u[2]);
      compress_store(out.names.light_v + k, going, n.u[3]);
      out.count += count(going);
    }
  }
}

template <int N>
CASTRAY_INLINE void copy_entry(VecArray<N>& to, uint32_t i, const float* x, const float* y, const float* z,
                               int k) {
  to.x[i] = x[k];
  to.y[i] = y[k];
  to.z[i] = z[k];
}

CASTRAY_INLINE const KernelMaterial& material_of(const KernelScene& scene, uint32_t record) {
  return scene.materials[(record & 0x7fffffffu) / material_floats];
}

/// Keeps where the suffixes have landed and what is emitted there, where light sampling shares it.
/// Diffuse and rough points are shared: what mirrors and glass send on goes on as a plain path of the pixel
/// it came from.
template <uint32_t features>
CASTRAY_INLINE void keep_suffixes(const Context& c, Vertices& y, Suffixes& suffixes) {
  for (int k = 0; k < y.count; ++k) {
    const uint32_t suffix = y.names.slot[k] - batch_size;
    const KernelMaterial& material = material_of(c.scene, y.material[k]);
    const bool both_sides = material.traits & trait_emits_behind;
    const bool shines = c.options.mis && (both_sides || y.material[k] >> 31);
    suffixes.landed[suffix] = 1;
    copy_entry(suffixes.p, suffix, y.p.x, y.p.y, y.p.z, k);
    copy_entry(suffixes.normal, suffix, y.normal.x, y.normal.y, y.normal.z, k);
    const auto emission = [&](int c) {
      if (!shines) return 0.f;
      return (features & feature_detail) ? y.parameters.value[slot_emission + c][k]
                                         : material.value[slot_emission + c];
    };
    suffixes.emission.x[suffix] = emission(0);
    suffixes.emission.y[suffix] = emission(1);
    suffixes.emission.z[suffix] = emission(2);
    suffixes.light_density[suffix] =
        material.light_density * (float)c.options.light_points / (both_sides ? 2.f : 1.f);
    suffixes.glossy[suffix] = 0;
    if (!(features & feature_materials) || !(material.traits & trait_directional)) continue;
    if (material.traits & trait_shareable) {
      suffixes.glossy[suffix] = 1;
      suffixes.material[suffix] = y.material[k];
      copy_entry(suffixes.shading_normal, suffix, y.shading_normal.x, y.shading_normal.y, y.shading_normal.z,
                 k);
      copy_entry<features>(suffixes.parameters, suffix, y.parameters, k);
    } else {
      y.names.slot[k] = suffixes.origin[suffix];
      copy_entry(y.throughput, (uint32_t)k, suffixes.weight.x, suffixes.weight.y, suffixes.weight.z,
                 (int)suffix);
    }
  }
}

}  // namespace castray::CASTRAY_ISA
