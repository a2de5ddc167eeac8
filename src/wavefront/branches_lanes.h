#pragma once

#include "wavefront/clamp_lanes.h"
#include "wavefront/follow_lanes.h"
#include "wavefront/scratch_lanes.h"

namespace castray::CASTRAY_ISA {

CASTRAY_INLINE void scale_pixels(const Context& c, float factor, Radiance& radiance) {
  for (int i = 0; i < c.job.tiles * tile_pixels; i += width)
    store(radiance, i, load(radiance, i) * Float(factor));
}

/// Which random numbers the paths of some vertices take.
struct Sequences {
  alignas(64) UintArray key, index;
};

/// Gives vertices the random numbers of branch k of `branches`: over the samples of a pixel its branches
/// count up one sequence, so that their directions are as well spread as those of as many samples.
CASTRAY_INLINE void name_branch(const Sequences& whole, uint32_t branches, uint32_t k, Vertices& vertices) {
  constexpr uint32_t key_of_branches = 0x5b1ad3u, last = (1u << index_bits) - 1;
  for (int i = 0; i < vertices.count; i += width) {
    const Uint index = load(whole.index + i) * Uint(branches) + Uint(k);
    const Uint key = (index >> index_bits) + Uint(key_of_branches);
    store(vertices.names.key + i, hash_combine(load(whole.key + i), key));
    store(vertices.names.index + i, index & Uint(last));
  }
}

/// One light sample at each vertex that the camera sees, and several paths that go on from there. A sample
/// has the mean of these.
template <class Geometry, uint32_t features>
CASTRAY_INLINE void follow_branches(Context& c, Scratch& s) {
  light_vertices<Geometry, features>(c, s, s.camera, 0);
  keep_direct(c, s);
  Sequences whole;
  __builtin_memcpy(whole.key, s.camera.names.key, sizeof whole.key);
  __builtin_memcpy(whole.index, s.camera.names.index, sizeof whole.index);
  const auto branches = (uint32_t)c.options.branches;
  scale_pixels(c, (float)branches, s.radiance);
  for (uint32_t k = 0; k < branches; ++k) {
    name_branch(whole, branches, k, s.camera);
    if (c.left_to_light_paths)
      for (uint32_t& left : s.left_to_light_paths) left = 1;
    follow<Geometry, features>(c, s, s.camera, 0, c.options.first_roulette, nullptr, true);
  }
  scale_pixels(c, 1 / (float)branches, s.radiance);
}

}  // namespace castray::CASTRAY_ISA
