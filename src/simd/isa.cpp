#include <string>

#include "castray/error.h"
#include "wavefront/wavefront.h"

namespace castray {

namespace {

/// The build defines CASTRAY_KERNEL_set for each set: its kernel_api, or nullptr where it was left out.
struct InstructionSet {
  const char* name;
  bool (*runs_here)();
  const KernelApi& (*kernel)();  ///< itself code of the set
};

constexpr InstructionSet instruction_sets[] = {
    // the best first
    {"avx512",
     [] {
       return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
              __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq");
     },
     CASTRAY_KERNEL_avx512},
    {"avx2",
     [] {
       return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
              __builtin_cpu_supports("bmi2");
     },
     CASTRAY_KERNEL_avx2},
    {"sse4", [] { return __builtin_cpu_supports("sse4.2") != 0; }, CASTRAY_KERNEL_sse4},
    {"scalar", [] { return true; }, CASTRAY_KERNEL_scalar},
};

}  // namespace

const KernelApi& choose_kernel(const std::string& name) {
  std::string built;
  for (const InstructionSet& set : instruction_sets) {
    if (set.kernel) built += std::string(", ") + set.name;
    if (name == "auto" && set.kernel && set.runs_here()) return set.kernel();
  }
  for (const InstructionSet& set : instruction_sets) {
    if (name != set.name) continue;
    if (!set.runs_here()) throw InputError("--isa " + name + ": this processor does not have it; use auto");
    if (!set.kernel)
      throw InputError("--isa " + name + ": left out when this castray was built; use one of auto" + built);
    return set.kernel();
  }
  throw InputError("--isa " + name + ": unknown; use one of auto" + built);
}

}  // namespace castray
