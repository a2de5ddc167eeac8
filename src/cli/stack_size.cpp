#include "cli/stack_size.h"

#include <fmt/format.h>
#include <pthread.h>

#include <algorithm>
#include <cstdlib>
#include <limits>

#include "castray/error.h"

namespace castray::cli {

namespace {

std::size_t own_stack_size() {
  pthread_attr_t attributes;
  std::size_t size = std::numeric_limits<std::size_t>::max();
  if (pthread_getattr_np(pthread_self(), &attributes) != 0) return size;
  pthread_attr_getstacksize(&attributes, &size);
  pthread_attr_destroy(&attributes);
  return size;
}

}  // namespace

void check_stack_size() {
  constexpr std::size_t least = 256 * 1024;   // twice what the deepest scenes were seen to take
  constexpr std::size_t advised = 2 * least;  // the system keeps some KiB of what `ulimit -s` says
  std::size_t size = own_stack_size();  // of all threads, unless the environment says more of the others
  if (std::getenv("OMP_STACKSIZE") || std::getenv("GOMP_STACKSIZE")) {
#pragma omp parallel num_threads(2) reduction(min : size)
    size = std::min(size, own_stack_size());
  }
  if (size < least)
    throw InputError(fmt::format(
        "stacks of {0} KiB are too small; set `ulimit -s {1}`, and OMP_STACKSIZE to {1}K if it is set",
        size / 1024, advised / 1024));
}

}  // namespace castray::cli
