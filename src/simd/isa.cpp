#include <string>

#include "castray/error.h"
#include "wavefront/wavefront.h"

namespace castray {

const KernelApi& choose_kernel(const std::string& name) {
  struct Choice {
    const KernelApi& kernel;
    bool available;
  };
  const Choice choices[] = {
      // the best first
#ifdef CASTRAY_HAS_avx512
      {avx512::kernel_api(), __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
                                 __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq")},
#endif
#ifdef CASTRAY_HAS_avx2
      {avx2::kernel_api(),
       __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi2")},
#endif
#ifdef CASTRAY_HAS_sse4
      {sse4::kernel_api(), __builtin_cpu_supports("sse4.2") != 0},
#endif
#ifdef CASTRAY_HAS_scalar
      {scalar::kernel_api(), true},
#endif
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

}  // namespace castray
