#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <vector>

#include "ray_files.h"

namespace castray {

/// What the programs that count rays per second are asked for, castray's and those of its rivals alike.
struct RayBenchOptions {
  std::string mesh, places, mode = "closest", out;
  std::vector<std::string> rays;
  int threads = 1, repeat = 5;
};

void add_ray_bench_options(CLI::App& app, RayBenchOptions& options);

/// Traces rays [first, last) into `results` at first .. last - 1.
using TraceRays = std::function<void(const RayArrays& rays, bool any, std::size_t first, std::size_t last,
                                     RayResult* results)>;

/// Traces every set of rays in every mode asked for; prints a line for each: rays per processor second and
/// thread, the median of the repetitions. Processor time, as other programs may run on the machine.
void measure_rays(const RayBenchOptions& options, const TraceRays& trace);

struct BuildCost {
  double cpu_seconds, seconds;
  std::size_t bytes;  ///< held afterwards
};

/// Runs `build`, which returns the bytes held.
BuildCost timed_build(const std::function<std::size_t()>& build);

/// Builds again and again, with one thread and with two; prints the median processor time with one, the least
/// time with two (what others leave of the machine is not in it), and what is held.
void measure_build(const RayBenchOptions& options, std::size_t triangles,
                   const std::function<BuildCost(int threads)>& build);

}  // namespace castray
