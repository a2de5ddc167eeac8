#include "core/threads.h"

#include <sched.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>
#include <string>
#include <thread>

namespace castray {

namespace {

namespace fs = std::filesystem;

constexpr double unlimited = std::numeric_limits<double>::infinity();

int affinity_count() {
  cpu_set_t mask;
  if (sched_getaffinity(0, sizeof mask, &mask) == 0) return std::max(1, CPU_COUNT(&mask));
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

double quotient(double quota, double period) { return quota > 0 && period > 0 ? quota / period : unlimited; }

/// Version 2: "QUOTA PERIOD" or "max PERIOD", in microseconds.
double quota_v2(const fs::path& group) {
  std::ifstream file(group / "cpu.max");
  double quota = 0, period = 0;
  return file >> quota >> period ? quotient(quota, period) : unlimited;
}

/// Version 1: two files; a quota of -1 is none.
double quota_v1(const fs::path& group) {
  std::ifstream quota_file(group / "cpu.cfs_quota_us"), period_file(group / "cpu.cfs_period_us");
  double quota = 0, period = 0;
  return quota_file >> quota && period_file >> period ? quotient(quota, period) : unlimited;
}

/// The lowest quota of `group` below `root` and of all groups above it.
template <class Quota>
double lowest(const fs::path& root, const std::string& group, Quota quota) {
  double result = unlimited;
  for (fs::path path = root / fs::path(group).relative_path();; path = path.parent_path()) {
    result = std::min(result, quota(path));
    if (path == root || !path.has_relative_path()) return result;
  }
}

double cgroup_quota() {
  double quota = std::min(quota_v2("/sys/fs/cgroup"), quota_v1("/sys/fs/cgroup/cpu"));
  std::ifstream groups("/proc/self/cgroup");  // lines "ID:CONTROLLERS:PATH"
  for (std::string line; std::getline(groups, line);) {
    std::istringstream fields(line);
    std::string id, controllers, path;
    if (!std::getline(fields, id, ':') || !std::getline(fields, controllers, ':')) continue;
    std::getline(fields, path);
    if (controllers.empty())
      quota = std::min(quota, lowest("/sys/fs/cgroup", path, quota_v2));
    else if (("," + controllers + ",").find(",cpu,") != std::string::npos)
      quota = std::min(quota, lowest("/sys/fs/cgroup/cpu", path, quota_v1));
  }
  return quota;
}

}  // namespace

int available_threads() {
  const double quota = std::ceil(cgroup_quota());
  const int processors = affinity_count();
  return quota < processors ? std::max(1, static_cast<int>(quota)) : processors;
}

}  // namespace castray
