#include "ray_bench.h"

#include <fmt/core.h>

#include <ctime>

namespace castray {
namespace {

double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

void measure(const RayBenchOptions& options, const std::string& file, const std::string& mode,
             const TraceRays& trace) {
  const RayArrays rays = read_rays(file);
  if (rays.size() == 0) throw InputError({file}, "holds no ray");
  std::vector<RayResult> results(rays.size());
  constexpr std::int64_t run = 4096;
  const auto count = static_cast<std::int64_t>(rays.size());
  std::vector<double> seconds;
  for (int i = 0; i < options.repeat; ++i) {
    const double start = cpu_seconds();
#pragma omp parallel for schedule(dynamic) num_threads(options.threads)
    for (std::int64_t first = 0; first < count; first += run) {
      trace(rays, mode == "any", static_cast<std::size_t>(first),
            static_cast<std::size_t>(std::min(first + run, count)), results.data());
    }
    seconds.push_back((cpu_seconds() - start) / options.threads);
  }
  if (!options.out.empty()) write_results(results, options.out);
  fmt::print("{} {}: {:.3f} million rays/s; {} rays, {} hit\n", file, mode,
             static_cast<double>(count) / median(seconds) / 1e6, count, count_hits(results));
}

}  // namespace

void add_ray_bench_options(CLI::App& app, RayBenchOptions& options) {
  app.add_option("mesh", options.mesh, "raw float32, 9 a triangle; castray-generate writes them")->required();
  app.add_option("--places", options.places,
                 "raw float32, 12 a place, rows of a 3x4 matrix: the mesh, in [-1,1], is there as instances");
  app.add_option("--rays", options.rays,
                 "raw float32: ox oy oz dx dy dz t_max; several files; none: only the build is timed");
  app.add_option("--threads", options.threads)->check(CLI::PositiveNumber)->capture_default_str();
  app.add_option("--mode", options.mode)
      ->check(CLI::IsMember({"closest", "any", "both"}))
      ->capture_default_str();
  app.add_option("--repeat", options.repeat, "the median is told")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app.add_option("--out", options.out, "t (float32) and triangle (uint32) of each ray");
}

void measure_rays(const RayBenchOptions& options, const TraceRays& trace) {
  if (!options.out.empty() && (options.rays.size() != 1 || options.mode == "both"))
    throw InputError("--out takes the results of one --rays file in one --mode");
  for (const std::string& file : options.rays) {
    for (const char* mode : {"closest", "any"}) {
      if (options.mode == mode || options.mode == "both") measure(options, file, mode, trace);
    }
  }
}

BuildCost timed_build(const std::function<std::size_t()>& build) {
  const double cpu = cpu_seconds();
  const auto start = std::chrono::steady_clock::now();
  const std::size_t bytes = build();
  return {cpu_seconds() - cpu, seconds_since(start), bytes};
}

void measure_build(const RayBenchOptions& options, std::size_t triangles,
                   const std::function<BuildCost(int threads)>& build) {
  std::vector<double> one, two;
  std::size_t bytes = 0;
  for (int i = 0; i < options.repeat; ++i) {
    one.push_back(build(1).cpu_seconds);
    const BuildCost cost = build(2);
    two.push_back(cost.seconds);
    bytes = cost.bytes;
  }
  fmt::print("build: {:.4f} s with 1 thread, {:.4f} s with 2; {:.1f} bytes a triangle\n", median(one),
             *std::min_element(two.begin(), two.end()),
             static_cast<double>(bytes) / static_cast<double>(std::max<std::size_t>(1, triangles)));
}

}  // namespace castray
