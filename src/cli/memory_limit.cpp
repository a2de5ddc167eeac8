#include "cli/memory_limit.h"

#include <fmt/format.h>
#include <malloc.h>
#include <pthread.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <map>

#include "cli/values.h"

namespace castray::cli {

namespace {

constexpr std::uint64_t mebibyte = 1 << 20;

/// The program's memory in bytes, by what the kernel calls it (proc(5)).
class Status {
 public:
  Status() {
    std::ifstream in("/proc/self/status");
    std::string name, line;
    for (; in >> name; std::getline(in, line))
      if (name.starts_with("Rss") || name.starts_with("Vm")) in >> kibibytes_[name];
  }
  std::uint64_t operator[](const std::string& name) const {
    const auto found = kibibytes_.find(name + ":");
    return found == kibibytes_.end() ? 0 : 1024 * found->second;
  }

 private:
  std::map<std::string, std::uint64_t> kibibytes_;
};

std::uint64_t bytes_of_stack() {
  pthread_attr_t attributes;
  std::size_t bytes = 0;
  if (pthread_attr_init(&attributes) != 0) return 0;
  pthread_attr_getstacksize(&attributes, &bytes);
  pthread_attr_destroy(&attributes);
  return bytes;
}

/// Lets the program's own memory, as address space, grow to `bytes`; returns what it might grow to before.
std::uint64_t set_data_limit(std::uint64_t bytes) {
  rlimit limit{};
  getrlimit(RLIMIT_DATA, &limit);
  const rlim_t former = limit.rlim_cur;
  limit.rlim_cur = std::min<rlim_t>(bytes, limit.rlim_max);
  setrlimit(RLIMIT_DATA, &limit);
  return former;
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
  const double mebibytes = static_cast<double>(bytes) / mebibyte;
  return mebibytes < 1024 ? fmt::format("{:.1f} MiB", mebibytes)
                          : fmt::format("{:.2f} GiB", mebibytes / 1024);
}

std::uint64_t bytes_of_program() {
  // Pages of code come into memory when they are first needed, some sooner, some later: whole steps are the
  // same each time.
  constexpr std::uint64_t to_come = 3 * mebibyte, step = 4 * mebibyte;
  const Status status;
  return status["RssAnon"] + (status["RssFile"] + to_come + step - 1) / step * step;
}

std::string more_is_needed(std::uint64_t limit, const std::string& what, std::uint64_t least) {
  const std::uint64_t chance = mebibyte / 2;  // by which two runs differ
  return fmt::format("--memory-limit of {}: {}; give --memory-limit {}M or more", bytes_text(limit), what,
                     (least + chance + mebibyte - 1) / mebibyte);
}

void return_freed_memory() {
  constexpr int small = 1 << 17;  // the C library's own at first, which it raises
  mallopt(M_MMAP_THRESHOLD, small);
  mallopt(M_TRIM_THRESHOLD, small);
}

MemoryLimit::MemoryLimit(std::uint64_t bytes, int threads) {
  return_freed_memory();
  // The kernel limits address space: stacks, and what large pages leave unused, are no memory.
  const Status status;
  const std::uint64_t there = status["RssAnon"] + status["RssFile"];
  const std::uint64_t more = std::max(bytes, there) - there, unused = more / 4 + 8 * mebibyte;
  former_ = set_data_limit(status["VmData"] + more + unused +
                           static_cast<std::uint64_t>(threads) * bytes_of_stack());
}

MemoryLimit::~MemoryLimit() { set_data_limit(former_); }

}  // namespace castray::cli
