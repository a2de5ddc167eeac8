#pragma once

#include <cstdint>
#include <optional>

#include "core/sequences.h"
#include "wavefront/pilot.h"

// Renderers whose noise is known, for what the pilot makes of it.

namespace castray::test {

/// Of tile k of a job.
inline int x_of(const TileJob& job, std::uint32_t k) { return job.places[k].x; }

/// Uniform in [-1,1).
inline float noise(std::uint32_t seed, const TileJob& job, std::uint32_t tile, std::uint32_t pixel,
                   std::uint32_t kind) {
  std::uint32_t h = hash_combine(seed, static_cast<std::uint32_t>(x_of(job, tile)));
  for (const std::uint32_t k :
       {static_cast<std::uint32_t>(job.places[tile].y), static_cast<std::uint32_t>(job.sample), pixel, kind})
    h = hash_combine(h, k);
  return static_cast<float>(h >> 8) * 0x1p-23f - 1;
}

/// A renderer whose pixels are 1 + what is seen of emitters, and noise of the given greatest size. Of a plain
/// sample's noise the other one of each two samples takes back `taken_back`. Rays are those of a tile.
inline RenderJob pretended(float shared_noise, float plain_noise, float emitted, std::uint64_t shared_rays,
                           std::uint64_t plain_rays, std::uint64_t gathered = 0, std::uint64_t evaluated = 0,
                           std::uint64_t asked = 0, float taken_back = 0) {
  return [=](const KernelOptions& options, const TileJob& job, TileResult& result) {
    const bool shared = options.suffixes > 0;
    TileJob other = job;
    other.sample ^= 1;
    const auto tiles = static_cast<std::uint32_t>(job.tiles);
    for (std::uint32_t k = 0; k < tiles; ++k)
      for (std::uint32_t i = 0; i < tile_pixels; ++i)
        for (std::uint32_t c = 0; c < 3; ++c) {
          const float seen = emitted * (1 + noise(options.seed, job, k, i, 7));
          const float of_sample = shared
                                      ? shared_noise * noise(options.seed, job, k, i, c)
                                      : plain_noise * (noise(options.seed, job, k, i, 3 + c) -
                                                       taken_back * noise(options.seed, other, k, i, 3 + c));
          result.radiance[c][k * tile_pixels + i] = seen + 1 + of_sample;
          result.emitted[c][k * tile_pixels + i] = seen;
        }
    result.rays += tiles * (shared ? shared_rays + gathered : plain_rays);
    result.gathered += tiles * (shared ? gathered : 0);
    result.asked += tiles * (shared ? asked : 0);
    result.evaluated += tiles * (shared ? evaluated : 0);
  };
}

inline KernelOptions sharing() {
  KernelOptions options{};
  options.suffixes = 64;
  options.ragged = 4;
  return options;
}

/// Of a pilot that has nothing else to choose.
inline std::optional<double> gain_of_sharing(const KernelOptions& options, int width, int height, int threads,
                                             const RenderJob& job, bool list = true) {
  return find_gains({width, height, list, threads, job}, options, {.caustics = false, .sharing = true}, {})
      .sharing_by_chance;
}

}  // namespace castray::test
