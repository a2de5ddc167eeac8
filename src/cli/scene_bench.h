#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "bench/report.h"
#include "castray/scene.h"
#include "cli/bench_meter.h"

namespace castray::cli {

/// The flags of `castray bench`, as given.
struct BenchFlags {
  std::vector<std::string> scenes, configurations, peers;
  std::vector<std::uint64_t> spp;
  std::vector<double> seconds;
  std::uint64_t seeds = 8;
  std::optional<double> equal_time;
  std::string size;
  std::string reference, reference_flags = "--reuse off", cache;
  std::uint64_t reference_spp = 1024;
  std::string mask = "emitters";
  bool ablation = false;
  int threads = 0;
  std::string json, csv, html, svg, pictures;
  bool quiet = false;
};

/// Throws what later renders of the scene would, before the first of them takes its time.
void check_bench_scene(const BenchFlags& flags, const Scene& scene);

/// The benchmark of the scene of a file.
BenchScene bench_scene(const BenchFlags& flags, const Scene& scene, const std::string& file,
                       BenchMeter& meter);

}  // namespace castray::cli
