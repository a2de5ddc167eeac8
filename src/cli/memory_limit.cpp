#include "cli/memory_limit.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "castray/error.h"
#include "cli/values.h"

namespace castray::cli {

namespace {

constexpr std::uint64_t bytes_of_a_pixel = 52;  ///< three sums of two doubles, and a count

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

std::string bytes_text(std::uint64_t bytes) {
  const double mebibytes = static_cast<double>(bytes) / (1 << 20);
  return mebibytes < 1024 ? fmt::format("{:.1f} MiB", mebibytes)
                          : fmt::format("{:.2f} GiB", mebibytes / 1024);
}

std::string MemoryNeed::text() const {
  return fmt::format("{} with the scene read, at least {} for the film", bytes_text(scene), bytes_text(film));
}

MemoryNeed memory_need(const Window& window) {
  return {resident_bytes(), bytes_of_a_pixel * static_cast<std::uint64_t>(window.width()) *
                                static_cast<std::uint64_t>(window.height())};
}

MemoryLimit::MemoryLimit(std::uint64_t bytes, const MemoryNeed& need) {
  if (need.scene + need.film > bytes)
    throw InputError(
        fmt::format("--memory-limit of {}: more is needed: {}; render --crop windows and merge their films",
                    bytes_text(bytes), need.text()));
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
