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
  k.suffixes = options.reuse.automatic ? 32 : options.reuse.suffixes;
  k.light_points = 8;
  k.seed =
      hash_combine(static_cast<std::uint32_t>(options.seed), static_cast<std::uint32_t>(options.seed >> 32));
  return k;
}

/// The tiles that cover a window in one pass. Where paths are shared the grid is shifted anew in each pass,
/// so that no tile's edge stays in one place.
struct TileGrid {
  int shift_x = 0, shift_y = 0;  ///< of the grid, to the left and up, in pixels
  int x0 = 0, y0 = 0;            ///< first tile
  int width = 0, height = 0;     ///< in tiles

  int jobs_per_row() const { return (width + max_tiles - 1) / max_tiles; }
  int jobs() const { return jobs_per_row() * height; }
  TileJob job(int i, std::uint64_t pass) const {
    const int first = i % jobs_per_row() * max_tiles, x = x0 + first, y = y0 + i / jobs_per_row();
    return {x * tile_size - shift_x, y * tile_size - shift_y, x, y, std::min(max_tiles, width - first), pass};
  }
};

TileGrid tile_grid(const Window& window, const KernelOptions& options, std::uint64_t pass) {
  TileGrid grid;
  if (options.suffixes > 0) {
    const std::uint32_t h =
        hash_combine(hash_combine(options.seed, 0x5b1f7u), static_cast<std::uint32_t>(pass));
    grid.shift_x = static_cast<int>(h % tile_size);
    grid.shift_y = static_cast<int>(h / tile_size % tile_size);
  }
  grid.x0 = (window.x0 + grid.shift_x) / tile_size;
  grid.y0 = (window.y0 + grid.shift_y) / tile_size;
  grid.width = (window.x1 + grid.shift_x + tile_size - 1) / tile_size - grid.x0;
  grid.height = (window.y1 + grid.shift_y + tile_size - 1) / tile_size - grid.y0;
  return grid;
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
      const TileGrid grid = tile_grid(window, kernel_flags, pass);
#pragma omp for schedule(dynamic)
      for (int j = 0; j < grid.jobs(); ++j) {
        const TileJob job = grid.job(j, pass);
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
