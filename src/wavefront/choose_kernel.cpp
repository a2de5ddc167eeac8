#include "wavefront/choose_kernel.h"

#include "castray/error.h"
#include "simd/isa.h"

namespace castray {

namespace {

/// The build defines CASTRAY_KERNEL_set for each set: its kernel_api, or nullptr where it was left out.
struct Choice {
  const char* name;
  InstructionSet set;
  const KernelApi& (*kernel)();  ///< itself code of the set: only to be called where the processor has it
};

constexpr Choice choices[] = {
    // the best first
    {"avx512", InstructionSet::avx512, CASTRAY_KERNEL_avx512},
    {"avx2", InstructionSet::avx2, CASTRAY_KERNEL_avx2},
    {"sse4", InstructionSet::sse4, CASTRAY_KERNEL_sse4},
    {"scalar", InstructionSet::scalar, CASTRAY_KERNEL_scalar},
};

}  // namespace

const KernelApi& choose_kernel(const std::string& name) {
  std::string built;
  for (const Choice& c : choices) {
    if (c.kernel) built += std::string(", ") + c.name;
    if (name == "auto" && c.kernel && processor_has(c.set)) return c.kernel();
  }
  for (const Choice& c : choices) {
    if (name != c.name) continue;
    if (!processor_has(c.set))
      throw InputError("--isa " + name + ": this processor does not have it; use auto");
    if (!c.kernel)
      throw InputError("--isa " + name + ": left out when this castray was built; use one of auto" + built);
    return c.kernel();
  }
  throw InputError("--isa " + name + ": unknown; use one of auto" + built);
}

}  // namespace castray
