#include "integrate/wavefront.h"

#include <omp.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <memory>

#include "castray/error.h"
#include "core/sequences.h"
#include "integrate/kernel_scene.h"

namespace castray {

namespace {

struct Free {
  void operator()(void* p) const { std::free(p); }
};
using Scratch = std::unique_ptr<void, Free>;

Scratch allocate_scratch(const KernelApi& kernel) {
  return Scratch(std::aligned_alloc(64, (kernel.scratch_bytes + 63) / 64 * 64));
}

KernelOptions kernel_options(const RenderOptions& options) {
  KernelOptions k{};
  k.sobol = options.sampler == SamplerKind::sobol;
  k.jitter = options.jitter;
  k.fixed_roulette = options.rr.has_value();
  k.survival = static_cast<float>(options.rr.value_or(1.0));
  k.max_depth = static_cast<std::uint32_t>(options.max_depth);
  k.seed =
      hash_combine(static_cast<std::uint32_t>(options.seed), static_cast<std::uint32_t>(options.seed >> 32));
  return k;
}

/// Adds a job's samples to the film where they lie in its window.
void add_tiles(Film& film, const TileJob& job, const TileResult& result,
               std::vector<NonfiniteSample>& nonfinite) {
  const Window& window = film.window();
  for (int i = 0; i < job.tiles * tile_pixels; ++i) {
    const int x = job.x + i / tile_pixels * tile_size + i % tile_size, y = job.y + i / tile_size % tile_size;
    if (x < window.x0 || x >= window.x1 || y < window.y0 || y >= window.y1) continue;
    const Vec3f radiance{result.radiance[0][i], result.radiance[1][i], result.radiance[2][i]};
    if (is_finite(radiance))
      film.add(x, y, radiance);
    else
      nonfinite.push_back({x, y, job.sample});
  }
}

}  // namespace

const KernelApi& choose_kernel(const std::string& name) {
  struct Choice {
    const KernelApi& kernel;
    bool available;
  };
  const Choice choices[] = {
      {avx512::kernel_api(), __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
                                 __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq")},
      {avx2::kernel_api(),
       __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi2")},
      {sse4::kernel_api(), __builtin_cpu_supports("sse4.2") != 0},
      {scalar::kernel_api(), true},
  };
  std::string known;
  for (const Choice& c : choices) {
    if ((name == "auto" || name == c.kernel.name) && c.available) return c.kernel;
    if (name == c.kernel.name)
      throw InputError("--isa " + name + ": this processor does not have it; use auto");
    known += std::string(", ") + c.kernel.name;
  }
  throw InputError("--isa " + name + ": unknown; use one of auto" + known);
}

RenderResult render_wavefront(const Scene& scene, const RenderOptions& options,
                              const ProgressCallback& progress) {
  using Clock = std::chrono::steady_clock;
  const KernelApi& kernel = choose_kernel(options.isa);
  const KernelSceneData data(scene, options.width, options.height);
  const KernelOptions kernel_flags = kernel_options(options);
  Window window{options.width, options.height, 0, 0, options.width, options.height};
  if (options.crop)
    window = {options.width,    options.height,   options.crop->x0,
              options.crop->y0, options.crop->x1, options.crop->y1};
  double brightest = max_component(scene.environment);
  for (const Material& m : scene.materials) brightest = std::max(brightest, max_component(m.ke));
  RenderResult result{Film(window, brightest), {}};
  const SampleRange range = options.samples.value_or(SampleRange{0, options.spp});
  const int threads = options.threads > 0 ? options.threads : omp_get_max_threads();
  const int x0 = window.x0 / tile_size, y0 = window.y0 / tile_size;
  const int tiles_x = (window.x1 + tile_size - 1) / tile_size - x0,
            tiles_y = (window.y1 + tile_size - 1) / tile_size - y0;
  const int jobs_x = (tiles_x + max_tiles - 1) / max_tiles;
  const auto start = Clock::now();
  std::uint64_t rays = 0;
  (void)progress;
#pragma omp parallel num_threads(threads) reduction(+ : rays)
  {
    const Scratch scratch = allocate_scratch(kernel);
    std::vector<float> radiance(3 * batch_size);
    std::vector<NonfiniteSample> nonfinite;
    TileResult tile_result{{radiance.data(), radiance.data() + batch_size, radiance.data() + 2 * batch_size},
                           0};
    for (std::uint64_t pass = range.first; pass < range.first + range.count; ++pass) {
#pragma omp for schedule(dynamic)
      for (int j = 0; j < jobs_x * tiles_y; ++j) {
        const int first_tile = j % jobs_x * max_tiles;
        const TileJob job{(x0 + first_tile) * tile_size, (y0 + j / jobs_x) * tile_size,
                          std::min(max_tiles, tiles_x - first_tile), pass};
        kernel.render_tiles(data.view, kernel_flags, job, scratch.get(), tile_result);
        add_tiles(result.film, job, tile_result, nonfinite);
      }
    }
    rays += tile_result.rays;
  }
  result.stats.rays = rays;
  result.stats.render_seconds = std::chrono::duration<double>(Clock::now() - start).count();
  result.stats.isa = kernel.name;
  result.stats.threads = threads;
  result.stats.paths =
      static_cast<std::uint64_t>(window.width()) * static_cast<std::uint64_t>(window.height()) * range.count;
  result.film.samples = {range};
  return result;
}

}  // namespace castray
