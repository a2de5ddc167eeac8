#include "cli/memory_limit.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "castray/error.h"
#include "cli/values.h"
#include "plan/job.h"
#include "plan/memory_need.h"
#include "plan/plan.h"

namespace castray::cli {

namespace {

std::uint64_t resident_bytes() {
  std::ifstream in("/proc/self/statm");
  std::uint64_t all = 0, resident = 0;
  in >> all >> resident;
  return resident * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

}  // namespace

std::uint64_t parse_bytes(const std::string& flag, const std::string& text) {
  constexpr std::string_view units = "KMG";
  const std::size_t unit = text.empty() ? units.npos : units.find(text.back());
  const std::string number = unit == units.npos ? text : text.substr(0, text.size() - 1);
  const std::uint64_t factor = unit == units.npos ? 1 : std::uint64_t{1} << (10 * (unit + 1));
  return factor * parse_whole(flag, number, 1, (std::uint64_t{1} << 50) / factor);
}

std::uint64_t share_of_memory() {
  return static_cast<std::uint64_t>(sysconf(_SC_PHYS_PAGES)) *
         static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE)) / 2;
}

std::string bytes_text(std::uint64_t bytes) {
  const double mebibytes = static_cast<double>(bytes) / (1 << 20);
  return mebibytes < 1024 ? fmt::format("{:.1f} MiB", mebibytes)
                          : fmt::format("{:.2f} GiB", mebibytes / 1024);
}

std::string MemoryNeed::text() const {
  return fmt::format("{} with the scene read, {} for its tree and lights, {} for the film ({} a pixel)",
                     bytes_text(scene), bytes_text(preparation), bytes_text(film()), film_pixel);
}

MemoryNeed memory_need(const Scene& scene, const RenderOptions& options) {
  const Window window = window_of(scene.width, scene.height, options);
  const Plan plan = make_plan(scene, options, window);
  MemoryNeed need;
  need.scene = resident_bytes();
  need.preparation = bytes_to_prepare(scene, plan, options.integrator);
  need.differences = options.integrator != Integrator::reference && keeps_differences(options, plan);
  Film film({1, 1, 0, 0, 1, 1}, 1);
  if (plan.light_paths) film.keep_splats();
  if (need.differences) film.keep_differences();
  need.film_pixel = bytes_of_pixel(film);
  need.pixels = static_cast<std::uint64_t>(window.width()) * static_cast<std::uint64_t>(window.height());
  return need;
}

MemoryLimit::MemoryLimit(std::uint64_t bytes) {
  rlimit limit{};
  getrlimit(RLIMIT_DATA, &limit);
  former_ = limit.rlim_cur;
  limit.rlim_cur = std::min<rlim_t>(bytes, limit.rlim_max);
  setrlimit(RLIMIT_DATA, &limit);
}

MemoryLimit::~MemoryLimit() {
  rlimit limit{};
  getrlimit(RLIMIT_DATA, &limit);
  limit.rlim_cur = former_;
  setrlimit(RLIMIT_DATA, &limit);
}

}  // namespace castray::cli
